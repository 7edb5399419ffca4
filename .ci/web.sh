# Files for the tests of `web`, which .ci/run and .ci/nightly share.

# web_files FOLDER MESHLOD WEB_CONFORMANCE: fills a folder with small files of every kind, and what Rust
# says of them.
web_files() {
    local folder="$1" meshlod="$2" conformance="$3" pair name file queries
    mkdir -p "$folder"
    $meshlod sample torus "$folder/torus.ply" --faces 8000
    $meshlod build "$folder/torus.ply" "$folder/bare.mlod" --lossless
    $meshlod sample fish "$folder/fish.obj" --faces 4000
    $meshlod build "$folder/fish.obj" "$folder/fish.mlod"
    $meshlod sample terrain "$folder/terrain.ply" --faces 4000
    $meshlod build "$folder/terrain.ply" "$folder/field.mlod" --model right-triangles
    # One with many chunks, of which some may be missing between others.
    $meshlod sample gyroid "$folder/pieces.ply" --faces 60000
    $meshlod build "$folder/pieces.ply" "$folder/pieces.mlod" --estimates
    for pair in textured:duck.glb skinned:fox.glb scene:cesium-milk-truck.glb; do
        while read -r file; do $meshlod build "$file" "$folder/${pair%%:*}.mlod"; done < <(mesh "${pair#*:}")
    done
    for file in "$folder"/*.mlod; do
        name="$(basename "$file" .mlod)"
        if [ "$name" = pieces ]; then queries=30; else queries=300; fi
        $conformance "$file" "$folder/$name.json" "$queries"
    done
    web_packed "$folder" "$meshlod"
}

# web_packed FOLDER MESHLOD: compressed files of every scheme, each with an OBJ of what Rust decodes from it.
web_packed() {
    local folder="$1" meshlod="$2" from name scheme file
    mkdir -p "$folder/packed"
    for from in "$folder/torus.ply" "$folder/fish.obj" "$folder/terrain.ply" $(mesh fox.glb); do
        name="$(basename "${from%.*}")"
        $meshlod compress "$from" "$folder/packed/$name.mlz" --quiet
        for scheme in parts "parts --strips" lattice blocks; do
            # shellcheck disable=SC2086
            $meshlod compress "$from" "$folder/packed/$name-${scheme// --/-}.mlq" --scheme $scheme --quiet
        done
    done
    for file in "$folder"/packed/*.ml[qz]; do
        $meshlod decompress "$file" "$file.obj" --precision f64 --quiet
    done
}
