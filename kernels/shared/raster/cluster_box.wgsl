// The box around a cluster, world units; the fourth numbers are not read.

struct ClusterBox { low: vec4<f32>, high: vec4<f32> }
