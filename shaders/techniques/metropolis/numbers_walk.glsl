// What the forms have in common whose chains keep the random numbers of their current path: such a proposal is as likely as its reverse. To be
// included behind the form, which has defined Walk and walk_known.

// The acceptance ratio, but for target compression: f(y) T(y -> x) / (f(x) T(x -> y)) with both T alike.
float walk_ratio(Walk w, Proposal p, float proposed) { return proposed / p.from.contribution; }

uint walk_kind(Walk w, Proposal p) { return p.kind; }
uint walk_source(Walk w, Proposal p) { return bootstrap_source(p.kind, p.kind, 0.0); }
uint walk_sort(Walk w, Proposal p) { return p.large ? MUTATION_LARGE : MUTATION_SMALL; }
void walk_keep(Walk w, Proposal p, uint chain) { keep_numbers(p.random, chain, walk_known(w)); }
