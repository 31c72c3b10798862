use subpixel_shadows::glam::{DVec3, DVec4};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::facet_masks::{FacetMode, Settings};
use subpixel_shadows::methods::render::{Budget, Renderer};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Light, Scene, SceneOptions};
use subpixel_shadows::truth::{FacetInput, FacetTruth, SceneTruth, Tracer, join_mask};

#[test]
fn probe() {
    let gpu = Gpu::open(None).unwrap();
    let spec = std::env::var("PROBE").unwrap();
    for item in spec.split(',') {
        let mut p = item.split(':');
        let name = p.next().unwrap();
        let other_light = p.next().unwrap() == "1";
        let one = p.next() == Some("one");
        let size = if one { [800u32, 600u32] } else { [120, 90] };
        let samples = Samples::new(Pattern::default(), 32).unwrap();
        let facets = if one { FacetMode::One } else { FacetMode::All };
        let settings = Settings {
            size,
            map: if one { 512 } else { 128 },
            samples,
            facets,
            validity: true,
            cull_back: true,
            masks: MaskVariant::Exact,
            settle: true,
        };
        let mut scene = Scene::open(name, &SceneOptions::default()).unwrap();
        if other_light {
            let (lo, hi) = scene.mesh.bounds().unwrap();
            let (centre, radius) = ((lo + hi) * 0.5, (hi - lo).length() * 0.5);
            let l = scene.light.homogeneous();
            scene.light = if l.w == 0.0 {
                let at = centre + l.truncate().normalize() * radius * 2.0;
                Light::Point { position: at.as_vec3().into() }
            } else {
                Light::Directional { direction: (l.truncate() - centre).as_vec3().into() }
            };
        }
        let prepared = Prepared::new(&scene.mesh);
        let plan = Plan::of(&prepared, &scene.camera, &scene.light, &settings, false).unwrap();
        let tracer = Tracer::new(&prepared.mesh).unwrap();
        let truth =
            SceneTruth::new(&tracer, &scene.camera, &scene.light, &plan.settings.samples, size[0], size[1]).unwrap();
        let mut renderer = Renderer::new(&gpu, &prepared, &plan.settings, Budget::default()).unwrap();
        let out = renderer.render(&scene.camera, &scene.light).unwrap();
        let f = renderer.method().facets();
        let list = f.list.read(&gpu).unwrap();
        let masks = f.masks.read(&gpu).unwrap();
        let first = f.pixel_facets.read(&gpu).unwrap();
        let rays = scene.camera.rays(size[0], size[1]);
        let light = scene.light.homogeneous();
        eprintln!(
            "== {item} {:?} validity {} settle {} cull {}",
            scene.light, plan.settings.validity, plan.settings.settle, plan.settings.cull_back
        );
        let ft =
            FacetTruth::new(&tracer, &scene.camera, &scene.light, &plan.settings.samples, size[0], size[1]).unwrap();
        let ft = if plan.settings.validity { ft } else { ft.without_validity() };
        let show = |pixel: u32, fi: u32, wrong: u32, what: &str| {
            let facet = list[fi as usize];
            let t = facet.triangle;
            let c = tracer.corners(t).map(|c| c - rays.eye);
            let l = DVec4::from((light.truncate() - rays.eye * light.w, light.w));
            let n = (c[1] - c[0]).cross(c[2] - c[0]);
            let tl = l.truncate() - c[0] * l.w;
            let d = n.dot(tl) / n.length() / tl.length();
            let v = -n.dot(c[0]) / n.length() / c[0].length();
            let tilt = 2.0 * (c[1] - c[0]).length() * (c[2] - c[0]).length() / n.length();
            let r = ft
                .judge(&[FacetInput { pixel, triangle: t, coverage: [masks[3 * fi as usize], 0, 0, 0] }], None)
                .unwrap()[0];
            eprintln!(
                "{what} pixel {pixel} facet {fi} tri {t} {:?} state {} cov {:08x} occ {:08x} inv {:08x} wrong {wrong:08x} n.l {d:.3e} n.v {v:.3e} tilt {tilt:.1} len {:.3e} dist {:.3e}",
                prepared.mesh.triangles[t as usize],
                facet.state,
                masks[3 * fi as usize],
                masks[3 * fi as usize + 1],
                masks[3 * fi as usize + 2],
                (c[1] - c[0]).length(),
                c[0].length()
            );
            eprintln!(
                "    facet truth occ {:08x} valid {:08x} amb_o {:08x} amb_v {:08x}",
                r.occluded[0], r.valid[0], r.ambiguous_occluded[0], r.ambiguous_valid[0]
            );
            for k in 0..32 {
                if wrong >> k & 1 == 1 {
                    let o = plan.settings.samples.offsets()[k];
                    let (x, y) = (pixel % size[0], pixel / size[0]);
                    let ray = rays.direction(x as f64 + o[0] as f64, y as f64 + o[1] as f64);
                    let point = ray * (n.dot(c[0]) / n.dot(ray));
                    let dir = l.truncate() - point * l.w;
                    for s in 0..tracer.triangle_count() as u32 {
                        if s == t {
                            continue;
                        }
                        let q = tracer.corners(s).map(|c| c - rays.eye);
                        let m = (q[1] - q[0]).cross(q[2] - q[0]);
                        let tt = m.dot(q[0] - point) / m.dot(dir);

                        let e: Vec<f64> = (0..3)
                            .map(|i| {
                                let (a, b) = (q[i] - point, q[(i + 1) % 3] - point);
                                a.cross(b).dot(dir)
                            })
                            .collect();
                        let scale = m.length() * dir.length();
                        let ok = e.iter().all(|v| *v >= -1e-12 * scale) || e.iter().all(|v| *v <= 1e-12 * scale);
                        let single =
                            ft.judge_among(&FacetInput { pixel, triangle: t, coverage: [1 << k, 0, 0, 0] }, &[s]);
                        let near = FacetMargins::least(&c, &q, l, &rays, ray) > -0.05;
                        if near {
                            eprintln!("    NEAR");
                        }
                        if ok || near || single.ambiguous_occluded[0] != 0 && single.occluded[0] == 0 {
                            let h = q.map(|p| n.dot(p - c[0]) * n.dot(tl).signum() / n.length());
                            let sl =
                                m.dot(l.truncate() - q[0] * l.w) / m.length() / (l.truncate() - q[0] * l.w).length();
                            eprintln!(
                                "    sample {k} {:?}: occluder {s} {:?} t {tt:.3e} heights {h:?} m.l {sl:.3e} edges {e:?} scale {scale:.3e}",
                                o, prepared.mesh.triangles[s as usize]
                            );
                            for g in FacetMargins::of(&c, &q, l, &rays, ray) {
                                eprintln!("        {g}");
                            }
                            let single =
                                ft.judge_among(&FacetInput { pixel, triangle: t, coverage: [1 << k, 0, 0, 0] }, &[s]);
                            eprintln!(
                                "        alone: occ {:08x} amb {:08x}",
                                single.occluded[0], single.ambiguous_occluded[0]
                            );
                        }
                    }
                }
            }
        };
        let mut total = 0;
        if one {
            let set = subpixel_shadows::report::errors::FacetSet::read(&gpu, f, 1).unwrap();
            let e = subpixel_shadows::report::errors::FacetErrors::of(
                &set,
                &tracer,
                &scene.camera,
                &scene.light,
                &plan.settings,
                None,
            )
            .unwrap();
            eprintln!("{e:?}");
            if let Some([pixel, k, _]) = e.first_wrong {
                show(pixel, first[pixel as usize], 1 << k, "FIRST");
            }
        } else {
            for pixel in 0..size[0] * size[1] {
                let p = truth.pixel(pixel);
                if p.seen_count == 0 {
                    continue;
                }
                let off = u128::from(out.lit[pixel as usize] as u32) ^ join_mask(p.lit);
                if off == 0 {
                    continue;
                }
                let off = (off & !join_mask(truth.ambiguous_mask(pixel))) as u32;
                if off == 0 {
                    continue;
                }
                total += off.count_ones();
                for fi in first[pixel as usize]..first[pixel as usize + 1] {
                    let w = off & masks[3 * fi as usize];
                    if w != 0 {
                        show(pixel, fi, w, "ALL");
                    }
                }
            }
        }
        eprintln!("== {item}: {total}");
    }
}

struct FacetMargins;
impl FacetMargins {
    fn least(f: &[DVec3; 3], q: &[DVec3; 3], l: DVec4, rays: &subpixel_shadows::scene::PixelRays, r: DVec3) -> f64 {
        let n = (f[1] - f[0]).cross(f[2] - f[0]);
        let d = n.dot(f[0]);
        let m = (q[1] - q[0]).cross(q[2] - q[0]);
        let o = -m.dot(l.truncate() - q[0] * l.w).signum() * d.signum();
        let dist = |m: DVec3, a: DVec3| {
            let line = m * d - n * m.dot(a);
            line.dot(r) / line.dot(rays.step_x).hypot(line.dot(rays.step_y))
        };
        let mut v = dist(m, q[0]) * o;
        for i in 0..3 {
            let (a, b) = (q[i], q[(i + 1) % 3]);
            v = v.min(dist((b - a).cross(l.truncate() - a * l.w), a) * o);
        }
        v
    }
    fn of(
        f: &[DVec3; 3],
        q: &[DVec3; 3],
        l: DVec4,
        rays: &subpixel_shadows::scene::PixelRays,
        r: DVec3,
    ) -> Vec<String> {
        let n = (f[1] - f[0]).cross(f[2] - f[0]);
        let d = n.dot(f[0]);
        let dist = |m: DVec3, a: DVec3| {
            let line = m * d - n * m.dot(a);
            line.dot(r) / line.dot(rays.step_x).hypot(line.dot(rays.step_y))
        };
        let mut out = vec![];
        for i in 0..3 {
            let (a, b) = (q[i], q[(i + 1) % 3]);
            out.push(format!("edge {i}: {:.4} px", dist((b - a).cross(l.truncate() - a * l.w), a)));
        }
        out.push(format!("own: {:.4} px", dist((q[1] - q[0]).cross(q[2] - q[0]), q[0])));
        out
    }
}
