// What techniques with light subpaths or splats keep on the device: the beginning of their table, which is read once in each kernel.

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightSubpathTables { LightSubpathTable table; };

LightSubpathTable light_subpaths = LightSubpathTables(frame.technique).table;

// Where the records of a light subpath begin: their number, then room for as many of so many bytes as the table says.
uvec2 light_path_address(uint64_t index, uint record_bytes) {
    uint64_t bytes = 4ul + uint64_t(record_bytes) * uint64_t(light_subpaths.light_vertices);
    return unpack32(pack64(light_subpaths.light_paths) + index * bytes);
}

// Ends the records of a subpath that has met so many vertices: where those are more than there is room for, the ones that are kept stand for all.
#define LIGHT_PATH_CLOSE(kept, met)                                                                     \
    kept.count = min(met, light_subpaths.light_vertices);                                               \
    if (met > light_subpaths.light_vertices) {                                                          \
        for (uint i = 0u; i < kept.count; i++) kept.at[i].power *= kept_share(met);                     \
    }

// Within which this sample merges camera subpaths with vertices of light subpaths: the technique's own word.
float merge_radius() { return uintBitsToFloat(frame.word); }
