// The forms of `vcm`, PARAM1: which strategies take part.
const uint FORM_VCM = 0u; // all
const uint FORM_BPM = 1u; // bidirectional photon mapping: merges anywhere, and running into lights
const uint FORM_PPM = 2u; // progressive photon mapping: a merge at the camera's first vertex that is not a mirror or smooth glass
const uint FORM_BPT = 3u; // bidirectional path tracing: no merges

const bool CONNECTS = PARAM1 == FORM_VCM || PARAM1 == FORM_BPT;
const bool MERGES = PARAM1 != FORM_BPT;
const bool MERGES_FIRST = PARAM1 == FORM_PPM;
const bool MEETS_LENS = true;
