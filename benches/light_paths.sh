#!/usr/bin/env bash
# Speed against error of techniques with paths from the light, on rooms and on caustics: three pages in the folder that is given (out/light_paths
# otherwise). A good hour on two cores, which nothing else should use.
set -euo pipefail
out=$(realpath -m "${1:-out/light_paths}")
size=96x96
. "$(dirname "$0")/hard_light.sh"

add cornell 60
add cornell_spheres 40
add veach_mis 40
add bidirectional_room 40
add ring_caustic 120
add reflected_caustic 60
add torus_in_glass 60
add small_vcm 60
bench path,light,bdpt,photon,vcm "${SECONDS_PER_RUN:-2}" 5 page

# Where single pixels hold most of the error, it takes more seeds to tell techniques apart: in a caustic's room the lamp shines through
# glass, which one sample in some hundred finds.
add caustic_small_light 300
bench path,light,bdpt,photon,vcm "${SECONDS_PER_RUN:-2}" 32 page_caustic

# A glass carafe shows the lamp as glints, which chance alone finds. In an image of 96x96 they fill some thousandth of a pixel, and decide on all of
# the error: this one has the shape of the scene's own, and a long reference, for that to have its glints.
size=192x128
add door_ajar 780
bench path,light,bdpt,photon,vcm 8 20 page_door_ajar
