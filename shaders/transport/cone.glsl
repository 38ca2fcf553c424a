// How wide a path is: a cone around its ray (Amanatides 1984, "Ray tracing with cones"), by which textures are filtered
// (Akenine-Moller et al. 2021, "Improved shader and texture level of detail using ray cones"). The curvature of what
// reflects is left out, and so is a lens.

struct Cone {
    float width;  // at the ray's origin, in scene units
    float spread; // what the width grows by per distance
};

// The share of a pixel's width that its cone has. The lookup itself blurs over two texels of its level, and the samples of a
// pixel are spread over it: what a whole pixel's width takes of the noise beyond this is less than the blur that it adds.
const float CONE_PIXEL = 0.5;

// Solid angle of the cone that goes on from a lobe: this share of one over the density of the lobe's choice ...
const float CONE_SHARE = 1.0 / 256.0;
// ... but no wider than this.
const float WIDEST_SPREAD = 0.5;

// The cone of a pixel: its spread is that share of the root of the solid angle that the pixel covers in this direction.
Cone camera_cone(vec3 direction) {
    if (CAMERA == CAMERA_ORTHOGRAPHIC) return Cone(CONE_PIXEL * sqrt(length(cross(scene.lens_x, scene.lens_y))), 0.0);
    vec3 n = cross(scene.camera_dx, scene.camera_dy);
    float cosine = abs(dot(n, direction));
    return Cone(0.0, CONE_PIXEL * cosine * sqrt(cosine) / abs(dot(n, scene.camera_corner)));
}

float cone_width(Cone cone, float distance) { return cone.width + cone.spread * distance; }

// The cone that goes on in a direction chosen with a density over solid angle.
Cone scattered_cone(float width, float spread, float pdf_w) {
    return Cone(width, min(max(spread, sqrt(CONE_SHARE / pdf_w)), WIDEST_SPREAD));
}
