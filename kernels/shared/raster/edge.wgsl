// An edge of the mesh: its ends, and its two triangles, the second NO_TRIANGLE where it has not exactly one
// neighbour that winds as it should.

struct Edge { v0: u32, v1: u32, t0: u32, t1: u32 }
