// A model that streams, in React: npm install meshlod three react react-dom @react-three/fiber
import { Suspense } from "react";
import { createRoot } from "react-dom/client";
import { Canvas, useFrame, useLoader } from "@react-three/fiber";
import { MlodLoader } from "meshlod/three";

function Model({ url, pixels = 1, ...props }) {
    const mesh = useLoader(MlodLoader, url); // suspends until the coarsest level is there
    useFrame(({ camera, gl }) => mesh.update(camera, gl));
    return <primitive object={mesh} pixels={pixels} {...props} />;
}

createRoot(document.getElementById("root")).render(
    <Canvas camera={{ position: [0, 0, 3] }}>
        <hemisphereLight intensity={3} />
        <Suspense>
            <Model url="model.mlod" />
        </Suspense>
    </Canvas>,
);
