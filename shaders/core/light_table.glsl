// What techniques with light subpaths or splats keep on the device: the beginning of their table, which is read once in each kernel.

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightTables { LightTable table; };

LightTable light_table = LightTables(frame.technique).table;

// Within which this sample merges camera subpaths with vertices of light subpaths: the technique's own word.
float merge_radius() { return uintBitsToFloat(frame.word); }
