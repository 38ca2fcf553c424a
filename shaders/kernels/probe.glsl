// Kernels that run over arrays, for tests and for `lumbre rays`: the host hands them the addresses of what they read and of what they
// write in the place of the film's.
#define PROBE_OUTPUT frame.film
#define PROBE_INPUT frame.layers
