// The list of candidates with the counters of one band of facets before it.

struct Candidates {
    tally: array<atomic<u32>, 16>,
    seen: array<atomic<u32>, SEEN>,  // pairs listed lately, see candidate_pairs
    list: array<vec2<u32>>,  // facet, triangle
}

const SEEN = 65536u;

// Words of `tally`.

const TALLY_PAIRS = 0u;       // pixel-texel pairs needed
const TALLY_CANDIDATES = 1u;  // candidates needed
const TALLY_DOUBTS = 2u;      // candidates evaluated again with 46 bits
const TALLY_LONGEST = 3u;     // longest triangle list of a texel, where above seven eighths of a round
const TALLY_CUTS = 4u;        // candidates that may cut the facet within its pixel
const TALLY_TESTS = 5u;       // triangles tested against facets, low and high word, over all bands
