import tseslint from "typescript-eslint";

export default tseslint.config(
    { ignores: ["dist", "out", "*.mjs", "test/*.mjs"] },
    ...tseslint.configs.strict,
    {
        rules: {
            "@typescript-eslint/no-explicit-any": "error",
            // Strings are made of numbers all over.
            "@typescript-eslint/restrict-template-expressions": "off",
            complexity: ["error", 24],
            "max-lines-per-function": ["error", 60],
            "max-lines": ["error", 360],
        },
    },
    { files: ["test/*.ts"], rules: { "max-lines-per-function": "off" } },
);
