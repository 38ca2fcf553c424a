// The loop of every kernel that follows paths. A lane goes through the stages of one path after the other; one whose path has ended begins
// its next one at once instead of waiting for its neighbours.
//
// The arguments are the type of a lane's state and the functions of its stages, each of which takes that state alone:
//     bool open(out lane)      false where the lane has nothing to do
//     bool has_next(lane)      whether another path is left to begin
//     bool begin(inout lane)   begins it; false where it ends at once
//     bool extend(inout lane)  follows it to its next vertex: arrives, connects, scatters; false where it ends
//     void end(inout lane)     takes in what it found
//     void close(lane)         writes back what the lane holds
#define LANES(Lane, open, has_next, begin, extend, end, close)           \
    layout(local_size_x = WORKGROUP) in;                                 \
    void main() {                                                        \
        Lane lane;                                                       \
        if (gl_GlobalInvocationID.x >= frame.slot_count) return;         \
        if (!open(lane)) return;                                         \
        bool alive = false;                                              \
        while (alive || has_next(lane)) {                                \
            if (!alive) alive = begin(lane);                             \
            if (alive) alive = extend(lane);                             \
            if (!alive) end(lane);                                       \
        }                                                                \
        close(lane);                                                     \
    }
