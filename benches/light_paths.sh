#!/usr/bin/env bash
# Speed against error of techniques with paths from the light, on rooms and on caustics: a page in the folder that is given (out/light_paths
# otherwise). Some minutes on two cores, which nothing else should use.
set -euo pipefail
out=$(realpath -m "${1:-out/light_paths}")
size=96x96
. "$(dirname "$0")/hard_light.sh"

add cornell bdpt 20
add cornell_spheres bdpt 40
add veach_mis bdpt 40
add bidirectional_room bdpt 40
add door_ajar bdpt 40
add caustic_small_light bdpt 40
add ring_caustic vcm 60
add reflected_caustic vcm 60
add torus_in_glass vcm 60
add small_vcm vcm 60
bench path,light,bdpt,photon,vcm "${SECONDS_PER_RUN:-1.5}" 5
