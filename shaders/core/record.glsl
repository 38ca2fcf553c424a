// What `lumbre trace` is told of the paths of one sample, and `render --fireflies` of the brightest samples: records that the kernel appends as
// things happen. RECORDS is false in every other rendering, and nothing of this is left in its kernels.

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PathRecords { RecordHeader header; PathRecord at[]; };

// The path that this lane follows at present is to be recorded.
bool recorded = false;
uint recorded_pixel, recorded_sample;
bool recorded_from_light;

RecordHeader record_header() { return PathRecords(frame.records).header; }

bool record_wants(uint kind) { return (record_header().kinds >> kind & 1u) != 0u; }

bool record_wants_sample(uint pixel, uint sample_index) {
    RecordHeader wanted = record_header();
    return (wanted.pixel == NONE || wanted.pixel == pixel) && (wanted.sample_index == NONE || wanted.sample_index == sample_index);
}

void record_begin(uint index, uint sample_index, bool from_light, bool is_wanted) {
    RecordHeader wanted = record_header();
    recorded_pixel = index;
    recorded_sample = sample_index;
    recorded_from_light = from_light;
    recorded = is_wanted && (wanted.sample_index == NONE || wanted.sample_index == sample_index);
}

// Begins a sample of a pixel.
void record_begin_pixel(uint pixel, uint sample_index) {
    if (!RECORDS) return;
    uint wanted = record_header().pixel;
    record_begin(pixel, sample_index, false, wanted == NONE || wanted == pixel);
}

// Begins one of so many light subpaths. What is wanted may be a pixel's number: there may be fewer subpaths, which pixels share then.
void record_begin_light(uint index, uint sample_index, uint count) {
    if (!RECORDS) return;
    uint wanted = record_header().light_path;
    record_begin(index, sample_index, true, wanted != NONE && wanted % count == index);
}

// Begins a proposal of a chain; `mutation` is 0 of the bootstrap sample that it begins at.
void record_begin_proposal(uint chain, uint mutation, uint sample_index) {
    if (!RECORDS) return;
    RecordHeader wanted = record_header();
    record_begin(chain, sample_index, false, wanted.chain == chain && wanted.mutation == mutation);
}

// Whether the lane's path is recorded with this kind.
bool records(uint kind) {
    if (!RECORDS) return false;
    return recorded && record_wants(kind);
}

// A record of this kind, of the path at hand, with nothing in it yet.
PathRecord record_of(uint kind, uint vertex) {
    return PathRecord(kind, recorded_pixel, recorded_sample, recorded_from_light ? 1u : 0u, vertex, 0u, 0u, NONE, NONE, NONE, 0u, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0),
                      vec3(0.0), 0.0, 0.0, 0.0, 0.0);
}

void record_append(PathRecord r) {
    PathRecords to = PathRecords(frame.records);
    uint place = atomicAdd(to.header.count, 1u);
    if (place < to.header.capacity) to.at[place] = r;
}

// What a path of `length` segments adds to the sample at hand.
void record_contribution(uint length, vec3 value) {
    if (!records(RECORD_CONTRIBUTION) || value == vec3(0.0)) return;
    PathRecord r = record_of(RECORD_CONTRIBUTION, length);
    r.value = value;
    record_append(r);
}

// The strategy (s, t) with its contribution and its MIS weight.
void record_strategy(uint s, uint t, vec3 value, float weight, uint flags) {
    if (!records(RECORD_STRATEGY)) return;
    PathRecord r = record_of(RECORD_STRATEGY, s + t - 1u);
    r.s = s;
    r.t = t;
    r.value = value;
    r.weight = weight;
    r.flags = flags;
    record_append(r);
}

// What this lane's light subpath, or chain, adds to a pixel that may be anywhere.
void record_splat(uint pixel, uint sample_index, uint source, uint s, uint t, vec3 value, float weight) {
    if (!RECORDS) return;
    if (value == vec3(0.0)) return;
    if (!record_wants(RECORD_SPLAT) || !record_wants_sample(pixel, sample_index)) return;
    PathRecord r = record_of(RECORD_SPLAT, source);
    r.pixel = pixel;
    r.sample_index = sample_index;
    r.from_light = 1u;
    r.s = s;
    r.t = t;
    r.value = value;
    r.weight = weight;
    record_append(r);
}

// The mutation that has proposed the path at hand, and what its contribution is multiplied by.
void record_mutation(uint chain, uint mutation, uint sort, float share) {
    if (!records(RECORD_MUTATION)) return;
    PathRecord r = record_of(RECORD_MUTATION, sort);
    r.s = chain;
    r.t = mutation;
    r.weight = share;
    record_append(r);
}

// The value of a finished sample, as the film takes it.
void record_value(uint pixel, uint sample_index, vec3 value, float filter_weight) {
    if (!RECORDS) return;
    if (!record_wants(RECORD_VALUE) || !record_wants_sample(pixel, sample_index)) return;
    if (max(value.x, max(value.y, value.z)) <= record_header().threshold) return; // what is no number is recorded
    PathRecord r = record_of(RECORD_VALUE, 0u);
    r.pixel = pixel;
    r.sample_index = sample_index;
    r.value = value;
    r.probability = filter_weight;
    record_append(r);
}
