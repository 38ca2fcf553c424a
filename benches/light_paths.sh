#!/usr/bin/env bash
# Speed against error of techniques with paths from the light, on rooms and on caustics: a page in the folder that is given (out/light_paths
# otherwise). References come from the technique that each scene is least hard for; those of vcm are blurred by far less than the
# runs' own error. Some minutes on two cores, which nothing else should use.
set -euo pipefail
cd "$(dirname "$0")/.."
lumbre=${LUMBRE:-target/release/lumbre}
out=${1:-out/light_paths}
seconds=${SECONDS_PER_RUN:-1.5}
size=96x96
mkdir -p "$out/references"

scenes=()
references=()
add() { # scene, technique of the reference, seconds
    local file="$out/references/$1.exr"
    [ -f "$file" ] || "$lumbre" render "scenes/$1.xml" -i "$2" -t "$3" --size $size --seed 4000 --aov variance -o "$file" -q
    scenes+=("scenes/$1.xml")
    references+=(--reference "$file")
}
add cornell bdpt 20
add cornell_spheres bdpt 40
add bidirectional_room bdpt 40
add door_ajar bdpt 40
add caustic_small_light bdpt 40
add ring_caustic vcm 60
add reflected_caustic vcm 60
add torus_in_glass vcm 60
add small_vcm vcm 60

"$lumbre" bench "${scenes[@]}" "${references[@]}" -i path,light,bdpt,photon,vcm --backend bvh -t "$seconds" --seeds 5 --size $size \
    -o "$out/page" --fresh
