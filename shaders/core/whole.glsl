// Floats that hold whole numbers, as integers, by their bits. A conversion does the same, but Mesa's CPU driver writes one for each lane, with
// branches for what does not fit: thirty times the instructions (docs/lavapipe.md).

// The largest whole number up to x, of 0 <= x < 2^23; of any other x some number below 2^23.
uint whole(float x) {
    precise float shifted = floor(x) + 8388608.0; // 2^23: the unit is the last bit
    return floatBitsToUint(shifted) & 0x7fffffu;
}

// The largest whole number up to x, of -2^22 <= x < 2^22; of any other x some number.
int whole_signed(float x) {
    precise float shifted = floor(x) + 12582912.0; // 2^23 + 2^22
    return floatBitsToInt(shifted) - 0x4b400000;
}

// The whole number nearest to x, of |x| < 2^63.
int64_t rounded64(float x) {
    uint bits = floatBitsToUint(round(x));
    int exponent = int(bits >> 23u & 0xffu) - 150; // of the last bit
    uint64_t mantissa = uint64_t(bits & 0x7fffffu | 0x800000u);
    int64_t magnitude = int64_t(exponent >= 0 ? mantissa << uint(exponent) : mantissa >> uint(min(-exponent, 63)));
    return (bits & 0x80000000u) != 0u ? -magnitude : magnitude;
}
