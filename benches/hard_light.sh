# For benches of light that is hard to find: references have more time than a bench gives them, and stay in the folder `out` for the next time. To be sourced, with `size` and `out` set.
cd "$(dirname "${BASH_SOURCE[0]}")/.."
lumbre=${LUMBRE:-target/release/lumbre}
mkdir -p "$out/references"

scenes=()
references=()
add() { # scene, seconds of the reference
    local file="$out/references/$1.exr"
    [ -f "$file" ] || "$lumbre" reference "scenes/$1.xml" -t "$2" --size "$size" -o "$file" -q
    scenes+=("scenes/$1.xml")
    references+=(--reference "$file")
}

bench() { # techniques, seconds of a run, seeds, folder of the page; forgets the scenes
    "$lumbre" bench "${scenes[@]}" "${references[@]}" -i "$1" --backend bvh -t "$2" --seeds "$3" --size "$size" -o "$out/$4" --fresh
    scenes=() references=()
}
