// The traversal stack. A CPU device addresses a private array lane by lane, which costs more than comparing the depth with
// every entry: there the array is only ever indexed by constants, and stays in registers. A GPU indexes it.

struct Stack {
    uvec2 at[STACK_SIZE];
    uint depth;
};

void push(inout Stack stack, uvec2 entry) {
    if (SELECT_STACK) {
        [[unroll]] for (uint i = 0u; i < STACK_SIZE; i++) { if (i == stack.depth) stack.at[i] = entry; }
    } else {
        stack.at[stack.depth] = entry;
    }
    stack.depth++;
}

uvec2 pop(inout Stack stack) {
    stack.depth--;
    if (!SELECT_STACK) return stack.at[stack.depth];
    uvec2 entry = stack.at[0];
    [[unroll]] for (uint i = 1u; i < STACK_SIZE; i++) { if (i == stack.depth) entry = stack.at[i]; }
    return entry;
}
