#!/usr/bin/env bash
# Speed against error of Metropolis light transport, in each form, with the techniques whose paths it takes: a page in the folder that is given
# (out/metropolis otherwise). Twenty minutes on two cores, which nothing else should use.
set -euo pipefail
out=$(realpath -m "${1:-out/metropolis}")
size=64x64
. "$(dirname "$0")/hard_light.sh"

add cornell 20
add bidirectional_room 40
add door_ajar 200
add ring_caustic 60
add torus_in_glass 60
bench path,bdpt,mlt:form=primary,mlt:form=multiplexed,mlt:form=paths "${SECONDS_PER_RUN:-3}" "${SEEDS:-6}" page
