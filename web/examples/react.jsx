// A model that streams, in React: npm install meshlod three react react-dom @react-three/fiber
import { Suspense } from "react";
import { createRoot } from "react-dom/client";
import { Canvas, useFrame, useLoader } from "@react-three/fiber";
import { MlodLoader } from "meshlod/three";

function Model({ url, pixels = 1, ...props }) {
    const mesh = useLoader(MlodLoader, url); // suspends until the coarsest level is there
    const { center, diagonal } = mesh.info;
    useFrame(({ camera, gl }) => mesh.update(camera, gl));
    return (
        <group scale={2 / diagonal} {...props}>
            <primitive object={mesh} pixels={pixels} position={center.map((x) => -x)} />
        </group>
    );
}

createRoot(document.getElementById("root")).render(
    <Canvas camera={{ position: [0, 0, 3] }}>
        <hemisphereLight intensity={3} />
        <Suspense>
            <Model url="model.mlod" />
        </Suspense>
    </Canvas>,
);
