//! Parts of a camera's view by what receives: clusters of objects that the camera sees, each with a view of the light of its own (Forsyth 2006: Extremely
//! Practical Shadows; Scherzer 2011, section 4.3: partitioning by receivers).
//!
//! An object is a box. What is seen of each has a rectangle on the light's map, a share of the image and a depth. Brought together are
//! those for which texels grow least beside pixels, until [`SplitPlan::MOST`](super::SplitPlan::MOST) clusters are left.

use super::{LightView, PartBy, SeenBox, SplitPlan, Warp};
use crate::scene::Camera;
use glam::{DVec2, DVec3};

/// The seen part of some objects.
#[derive(Clone, Copy, Debug)]
struct SeenCluster {
    /// Box of the objects.
    bounds: (DVec3, DVec3),
    /// Its rectangle on the light's map.
    on_map: (DVec2, DVec2),
    /// Share of the image over the square of the depth: as small pixels are there as many.
    weight: f64,
}

impl SeenCluster {
    fn joined(&self, other: &Self) -> Self {
        Self {
            bounds: (self.bounds.0.min(other.bounds.0), self.bounds.1.max(other.bounds.1)),
            on_map: (self.on_map.0.min(other.on_map.0), self.on_map.1.max(other.on_map.1)),
            weight: self.weight + other.weight,
        }
    }

    /// Area of a texel beside that of a pixel, over all pixels, but for a factor.
    fn cost(&self) -> f64 {
        let side = (self.on_map.1 - self.on_map.0).max(DVec2::splat(1e-3));
        side.x * side.y * self.weight
    }
}

impl SeenBox {
    /// The parts of what is seen between two depths that clusters of these objects, boxes in the space of the view, take: `most` at most.
    pub(super) fn clusters(
        &self,
        view: &LightView,
        objects: &[(DVec3, DVec3)],
        [near, far]: [f64; 2],
        most: usize,
    ) -> Vec<Self> {
        let of_box = |&bounds: &(DVec3, DVec3)| {
            let own = Self { bounds: self.held(bounds)?, ..*self };
            own.seen_cluster(view, near, far)
        };
        let mut clusters: Vec<SeenCluster> = objects.iter().filter_map(of_box).collect();
        while clusters.len() > most {
            let pairs = (0..clusters.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
            let grows = |&(a, b): &(usize, usize)| {
                let [a, b] = [&clusters[a], &clusters[b]];
                a.joined(b).cost() - a.cost() - b.cost()
            };
            let Some((a, b)) = pairs.min_by(|x, y| grows(x).total_cmp(&grows(y))) else { break };
            let joined = clusters[a].joined(&clusters[b]);
            clusters.swap_remove(a);
            clusters[b] = joined;
        }
        clusters.into_iter().map(|cluster| Self { bounds: cluster.bounds, ..*self }).collect()
    }

    /// The part of a box, a little wider, that lies in the scene's.
    fn held(&self, (low, high): (DVec3, DVec3)) -> Option<(DVec3, DVec3)> {
        let slack = 1e-5 * (self.bounds.1 - self.bounds.0).max_element();
        let (low, high) = ((low - slack).max(self.bounds.0), (high + slack).min(self.bounds.1));
        low.cmple(high).all().then_some((low, high))
    }

    /// The seen part of the box; `None` if it is nothing.
    fn seen_cluster(&self, view: &LightView, near: f64, far: f64) -> Option<SeenCluster> {
        let part = self.part(view, near, far);
        let mut on_map = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut on_image = on_map;
        let mut depths = (f64::INFINITY, 0.0f64);
        let across = [self.corners[1] - self.corners[0], self.corners[3] - self.corners[0]];
        for &p in &part {
            let Some(at) = view.project(p) else { continue };
            let depth = p.dot(self.forward).max(near);
            let from_corner = p / depth - self.corners[0];
            let seen = DVec2::from(across.map(|side| from_corner.dot(side) / side.length_squared()));
            on_map = (on_map.0.min(at.truncate()), on_map.1.max(at.truncate()));
            on_image = (on_image.0.min(seen), on_image.1.max(seen));
            depths = (depths.0.min(depth), depths.1.max(depth));
        }
        let share = (on_image.1 - on_image.0).max(DVec2::splat(1e-4));
        let weight = share.x * share.y / (depths.0 * depths.1);
        (depths.0 <= depths.1).then_some(SeenCluster { bounds: self.bounds, on_map, weight })
    }
}

impl LightView {
    /// A view of this light for each cluster of objects that a camera sees between two corners of a box, those with the smallest texels first, in world units
    /// as this one's rows are. `objects`: boxes that together hold all receivers; what is seen of each this view holds lies in the view of its cluster.
    /// Warped as [slices](LightView::slices) are; one slice of all where nothing is seen of an object.
    pub fn clusters(
        &self,
        camera: &Camera,
        size: [u32; 2],
        bounds: (DVec3, DVec3),
        plan: &SplitPlan,
        objects: &[(DVec3, DVec3)],
    ) -> Vec<LightView> {
        let all = SplitPlan { by: PartBy::Depth, splits: 1, ..*plan };
        self.views_of(camera, size, bounds, &all, |whole, seen, all, (eye, scale)| {
            let objects: Vec<_> =
                objects.iter().map(|&(low, high)| ((low - eye) * scale, (high - eye) * scale)).collect();
            let views = whole.seen_depths(seen).filter(|_| all.warp != Warp::Whole).map(|depths| {
                let clusters = seen.clusters(whole, &objects, depths, SplitPlan::MOST as usize);
                whole.of_parts(clusters, all, depths)
            });
            views.filter(|views| !views.is_empty()).unwrap_or_else(|| whole.split(seen, all, 0.0, None))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::Prepared;
    use crate::scene::Light;
    use crate::test_scenes::builtin;
    use glam::Vec3;

    const SIZE: [u32; 2] = [64, 48];
    const CLUSTERS: SplitPlan = SplitPlan {
        by: PartBy::ReceiverClusters,
        splits: 1,
        warp: Warp::Fitted,
        focus: SplitPlan::FOCUS,
        weight: SplitPlan::WEIGHT,
    };

    fn holds(view: &LightView, p: DVec3) -> bool {
        let side = f64::from(view.map_size) + 1e-6;
        view.project(p).is_some_and(|t| t.truncate().min_element() > -1e-6 && t.truncate().max_element() < side)
    }

    /// Points of triangles that lie in sight.
    fn seen_points(prepared: &Prepared, camera: &Camera) -> Vec<DVec3> {
        let rays = camera.rays(SIZE[0], SIZE[1]);
        let mesh = prepared.mesh();
        let middle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| Vec3::from(mesh.positions[v as usize]).as_dvec3());
            [a * 0.98 + b * 0.01 + c * 0.01, (a + b + c) / 3.0, a * 0.1 + b * 0.45 + c * 0.45]
        };
        let in_sight = |p: &DVec3| {
            let depth = (*p - rays.eye).dot(rays.forward);
            if depth < f64::from(camera.near) {
                return false;
            }
            let from_corner = (*p - rays.eye) / depth - rays.corner;
            let x = from_corner.dot(rays.step_x) / rays.step_x.length_squared();
            let y = from_corner.dot(rays.step_y) / rays.step_y.length_squared();
            x > 0.0 && y > 0.0 && x < f64::from(SIZE[0]) && y < f64::from(SIZE[1])
        };
        mesh.triangles.iter().flat_map(middle).filter(in_sight).collect()
    }

    /// All of the surfaces in sight that the whole view holds lies on the map of a cluster; where one is left out, something mostly does not. The first
    /// spreads over less of the map than one view of all.
    #[test]
    fn clusters_hold_what_is_seen() {
        let [mut points, mut parts, mut missed, mut finer] = [0; 4];
        for name in ["windmill", "spheres", "plant"] {
            let scene = builtin(name);
            let prepared = Prepared::new(&scene.mesh).unwrap();
            let bounds = scene.mesh.bounds().unwrap();
            let near = Camera { eye: [0.4, 0.5, 1.1], target: [0.0, 0.8, 0.0], near: 0.01, ..scene.camera };
            for camera in [scene.camera, near] {
                for light in [
                    Light::Directional { direction: [0.3, 1.0, 0.2] },
                    Light::Directional { direction: [-0.2, 0.4, -1.0] },
                    Light::Point { position: [1.0, 20.0, 2.0] },
                ] {
                    let whole = LightView::fit(&scene.mesh, &light, 64).unwrap();
                    let seen: Vec<DVec3> =
                        seen_points(&prepared, &camera).into_iter().filter(|&p| holds(&whole, p)).collect();
                    points += seen.len();
                    for warp in [Warp::Box, Warp::LightSpace, Warp::Fitted] {
                        let plan = SplitPlan { warp, ..CLUSTERS };
                        let views = whole.clusters(&camera, SIZE, bounds, &plan, prepared.objects());
                        assert!((1..=4).contains(&views.len()) && views.iter().all(|v| v.one_of_several));
                        for &p in &seen {
                            assert!(views.iter().any(|v| holds(v, p)), "{name}: {p} is on no map: {light:?} {warp:?}");
                        }
                        for k in 0..views.len() {
                            let is_out = |p: &DVec3| !views.iter().enumerate().any(|(j, v)| j != k && holds(v, *p));
                            missed += usize::from(seen.iter().any(is_out));
                            parts += 1;
                        }
                        finer += usize::from(views.len() > 1);
                    }
                }
            }
        }
        assert!(points > 10_000 && finer > 30 && missed * 4 > parts, "{points}; {missed} of {parts} missed; {finer}");
    }

    /// Where no object is seen, or nothing at all, there is one view.
    #[test]
    fn nothing_is_one_view() {
        let scene = builtin("windmill");
        let bounds = scene.mesh.bounds().unwrap();
        let whole = LightView::fit(&scene.mesh, &Light::Directional { direction: [0.3, 1.0, 0.2] }, 64).unwrap();
        let far = [(DVec3::splat(1e5), DVec3::splat(2e5))];
        let of = |objects: &[(DVec3, DVec3)]| whole.clusters(&scene.camera, SIZE, bounds, &CLUSTERS, objects);
        let one = whole.slices(&scene.camera, SIZE, bounds, &SplitPlan { by: PartBy::Depth, ..CLUSTERS }, 0.0, None);
        assert_eq!(of(&far), one);
        assert_eq!(of(&[]), one);
        assert_eq!(of(&[bounds]).len(), 1);
    }
}
