// The affine maps of an instance.

vec3 rows_times(vec4 row0, vec4 row1, vec4 row2, vec4 v) { return vec3(dot(row0, v), dot(row1, v), dot(row2, v)); }

vec3 world_point(Instance i, vec3 p) { return rows_times(i.world0, i.world1, i.world2, vec4(p, 1.0)); }
vec3 world_vector(Instance i, vec3 v) { return rows_times(i.world0, i.world1, i.world2, vec4(v, 0.0)); }
vec3 object_point(Instance i, vec3 p) { return rows_times(i.object0, i.object1, i.object2, vec4(p, 1.0)); }
vec3 object_vector(Instance i, vec3 v) { return rows_times(i.object0, i.object1, i.object2, vec4(v, 0.0)); }

// Normals go by the transpose of the inverse; the result is not of unit length.
vec3 world_normal(Instance i, vec3 n) { return n.x * i.object0.xyz + n.y * i.object1.xyz + n.z * i.object2.xyz; }

// The maps with every product made positive: bounds on what rounding can do.
vec3 abs_world_point(Instance i, vec3 p) { return rows_times(abs(i.world0), abs(i.world1), abs(i.world2), vec4(p, 1.0)); }
vec3 abs_world_vector(Instance i, vec3 v) { return rows_times(abs(i.world0), abs(i.world1), abs(i.world2), vec4(v, 0.0)); }
vec3 abs_object_point(Instance i, vec3 p) { return rows_times(abs(i.object0), abs(i.object1), abs(i.object2), vec4(p, 1.0)); }
