// Finds the names of properties that may be shortened: those that are declared in `src` alone, and
// not in what goes from one script to another. Only members of classes: objects of options may belong to a
// browser.

import { join } from "node:path";
import ts from "typescript";

/** Files whose types cross the border of a script, by messages. */
const SHARED = [
    "load/messages.ts",
    "load/geometry.ts",
    "cut/query.ts",
    "scene/head.ts",
    "load/source.ts",
];

/** Returns the names that the worker may shorten. */
export function localNames(root) {
    const { config } = ts.readConfigFile(join(root, "tsconfig.json"), ts.sys.readFile);
    const { options } = ts.parseJsonConfigFileContent(config, ts.sys, root);
    const program = ts.createProgram([join(root, "src/worker.ts")], options);
    const checker = program.getTypeChecker();
    const sources = program
        .getSourceFiles()
        .filter(({ fileName }) => fileName.startsWith(join(root, "src")));
    const isShared = (file) => SHARED.some((name) => file.endsWith(`/src/${name}`));
    const isLocal = (symbol) =>
        symbol?.declarations?.every((declaration) => {
            const file = declaration.getSourceFile();
            const isPublic =
                isShared(file.fileName) && ts.isInterfaceDeclaration(declaration.parent);
            const isLiteral = isShared(file.fileName) && ts.isTypeLiteralNode(declaration.parent);
            return sources.includes(file) && !isPublic && !isLiteral;
        });
    const [found, kept, ofClasses] = [new Set(), new Set(), new Set()];
    const visit = (node) => {
        if (ts.isStringLiteralLike(node)) kept.add(node.text);
        const name = nameOf(node);
        if (name) (isLocal(symbolOf(checker, name)) ? found : kept).add(name.text);
        if (name && (ts.isClassElement(node) || ts.isParameter(node))) ofClasses.add(name.text);
        ts.forEachChild(node, visit);
    };
    sources.forEach(visit);
    return [...found].filter((name) => ofClasses.has(name) && !kept.has(name));
}

/** Returns the identifier of a property that a node declares, reads or writes. */
function nameOf(node) {
    if (ts.isPropertyAccessExpression(node)) return node.name;
    if (ts.isBindingElement(node) && ts.isObjectBindingPattern(node.parent))
        return node.propertyName ?? node.name;
    if (ts.isParameter(node) && ts.isParameterPropertyDeclaration(node, node.parent))
        return node.name;
    const isMember =
        ts.isPropertyDeclaration(node) ||
        ts.isMethodDeclaration(node) ||
        ts.isAccessor(node) ||
        ts.isPropertySignature(node) ||
        ts.isMethodSignature(node) ||
        ts.isPropertyAssignment(node) ||
        ts.isShorthandPropertyAssignment(node);
    return isMember && ts.isIdentifier(node.name) ? node.name : null;
}

/** Returns the property that an identifier stands for, not the variable that it may declare. */
function symbolOf(checker, name) {
    const { parent } = name;
    if (ts.isBindingElement(parent)) {
        const type = checker.getTypeAtLocation(parent.parent);
        return checker.getPropertyOfType(type, name.text);
    }
    if (ts.isShorthandPropertyAssignment(parent) || ts.isPropertyAssignment(parent)) {
        const type = checker.getContextualType(parent.parent);
        return (
            (type && checker.getPropertyOfType(type, name.text)) ??
            checker.getSymbolAtLocation(name)
        );
    }
    return checker.getSymbolAtLocation(name);
}
