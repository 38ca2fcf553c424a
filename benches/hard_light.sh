# For benches of light that is hard to find: references come from the technique that each scene is least hard for (those of vcm are blurred by
# far less than the runs' own error), and stay in the folder `out` for the next time. To be sourced, with `size` and `out` set.
cd "$(dirname "${BASH_SOURCE[0]}")/.."
lumbre=${LUMBRE:-target/release/lumbre}
mkdir -p "$out/references"

scenes=()
references=()
add() { # scene, technique of the reference, seconds
    local file="$out/references/$1.exr"
    [ -f "$file" ] || "$lumbre" render "scenes/$1.xml" -i "$2" -t "$3" --size "$size" --seed 4000 --aov variance -o "$file" -q
    scenes+=("scenes/$1.xml")
    references+=(--reference "$file")
}

bench() { # techniques, seconds of a run, seeds, folder of the page; forgets the scenes
    "$lumbre" bench "${scenes[@]}" "${references[@]}" -i "$1" --backend bvh -t "$2" --seeds "$3" --size "$size" -o "$out/$4" --fresh
    scenes=() references=()
}
