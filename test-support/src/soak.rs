//! One pass through very many frames: camera, light and casters move, sizes and casters change.

use crate::refused::words;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{Casters, FrameStatus, Inputs, Moved, PassConfig, Target, Vertices};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};

/// Legs after which everything comes again.
pub const LEGS: u64 = 30;

/// Image sizes that take turns.
const SIZES: [[u32; 2]; 5] = [[32, 24], [24, 24], [40, 20], [17, 31], [48, 12]];

/// What frame `k` of the soak is computed from.
struct Scene {
    size: [u32; 2],
    mesh: Mesh,
    /// Whether the vertices are moved by a buffer.
    moving: bool,
    camera: Camera,
    light: Light,
}

/// Memory after a frame.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Frames up to now.
    pub frame: u64,
    /// Bytes that the process has in memory.
    pub resident: u64,
    /// Bytes of all resources on the device.
    pub device: u64,
    /// Milliseconds since the row before, a frame.
    pub ms: f64,
}

/// How a soak went.
pub struct Soak {
    /// Measurements, in order.
    pub rows: Vec<Row>,
    /// Frames that were complete.
    pub complete: u64,
    /// Visibility and lit masks of the last frame, and of the same frame of a fresh pass.
    pub last: [Vec<u32>; 2],
}

/// A slab, and posts on it that differ by leg; of posts that move each vertex does.
fn mesh(leg: u64) -> Mesh {
    let mut mesh = Mesh::default();
    let mut add = |low: [f32; 3], high: [f32; 3]| {
        let first = mesh.positions.len() as u32;
        for k in 0..8 {
            mesh.positions.push([0, 1, 2].map(|a| if k >> a & 1 == 0 { low[a] } else { high[a] }));
        }
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            mesh.triangles.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|v| v + first)));
        }
    };
    add([-2.0, -0.2, -2.0], [2.0, 0.0, 2.0]);
    for k in 0..2 + leg % 4 {
        let (x, z) = (0.9 * (k as f32 * 2.1 + leg as f32).sin(), 0.9 * (k as f32 * 1.3 + leg as f32).cos());
        add([x - 0.1, 0.0, z - 0.1], [x + 0.1, 0.6 + 0.2 * k as f32, z + 0.1]);
    }
    mesh
}

impl Scene {
    fn of(frame: u64, leg: u64) -> Self {
        // All comes again after 30 legs: what memory has grown by then is a leak, not a longer list.
        let (leg, t) = (frame / leg % LEGS, (frame % (leg * LEGS)) as f32 * 0.013);
        let camera = Camera {
            eye: [4.0 * t.sin(), 2.0 + (0.7 * t).sin(), 4.0 * t.cos()],
            target: [0.2 * t.cos(), 0.3, 0.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 45.0 + 10.0 * (0.3 * t).sin(),
            near: 0.01,
            far: 100.0,
            lens: Lens::CENTRED,
            near_plane: None,
        };
        let [x, z] = [(1.7 * t).sin(), (1.7 * t).cos()];
        let light = match leg % 3 {
            0 => Light::Directional { direction: [x, 1.0, z] },
            1 => Light::Point { position: [2.0 * x, 3.0, 2.0 * z] },
            // Among the casters: several views.
            _ => Light::Point { position: [0.4 * x, 0.5, 0.4 * z] },
        };
        Self { size: SIZES[leg as usize % SIZES.len()], mesh: mesh(leg), moving: leg % 2 == 1, camera, light }
    }

    fn casters(&self) -> Casters<'_> {
        let (positions, triangles) = (&self.mesh.positions[..], &self.mesh.triangles[..]);
        match self.moving {
            false => Casters::Static { positions, triangles },
            true => Casters::Moving { rest: positions, triangles },
        }
    }
}

/// The application's own things.
struct App<'a> {
    gpu: &'a Gpu,
    facets: FacetMode,
    leg: u64,
    vertices: wgpu::Buffer,
}

impl<'a> App<'a> {
    fn new(gpu: &'a Gpu, facets: FacetMode, leg: u64) -> Self {
        let vertices = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("soak.vertices"),
            size: 12 * 8 * 16,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { gpu, facets, leg, vertices }
    }

    fn pass(&self, scene: &Scene) -> Result<ShadowPass> {
        let samples = Samples::new(Pattern::LowDiscrepancy, 8)?;
        let settings = Settings { facets: self.facets, ..Settings::new(scene.size, 32, samples) };
        let config = PassConfig { keep_last: true, ..PassConfig::new(settings, scene.casters()) };
        ShadowPass::new(&self.gpu.device, &self.gpu.queue, &config)
    }

    /// One frame, and how it came out.
    fn frame(&self, pass: &mut ShadowPass, scene: &Scene, frame: u64) -> Result<FrameStatus> {
        let moved = scene.moving.then(|| {
            let t = (frame % (self.leg * LEGS)) as f32 * 0.05;
            let place = |p: &[f32; 3]| [p[0] + 0.1 * (t + p[1]).sin(), p[1], p[2]];
            let words: Vec<[f32; 3]> = scene.mesh.positions.iter().map(place).collect();
            self.gpu.queue.write_buffer(&self.vertices, 0, bytemuck::cast_slice(&words));
            let vertices = Vertices { buffer: &self.vertices, offset: 0, stride: 12 };
            Moved { vertices, bounds: [[-2.2, -0.3, -2.2], [2.2, 2.0, 2.2]] }
        });
        let inputs = Inputs { moved, ..Inputs::new(&scene.camera, &scene.light) };
        let mut encoder = self.gpu.encoder();
        let number = pass.record(&mut encoder, &inputs, &Target::default())?;
        self.gpu.submit_and_wait(encoder)?;
        for _ in 0..5000 {
            match pass.status() {
                Some(status) if status.frame == number => return Ok(status),
                Some(_) => {}
                None => std::thread::sleep(std::time::Duration::from_millis(1)),
            }
        }
        Err(Error::Gpu(format!("nothing is known of frame {number}")))
    }
}

/// Runs so many frames of one pass, other sizes and casters every `leg` frames, and notes every `every` frames what is in memory.
pub fn soak(
    gpu: &Gpu,
    facets: FacetMode,
    frames: u64,
    leg: u64,
    every: u64,
    told: &mut dyn FnMut(&Row),
) -> Result<Soak> {
    let app = App::new(gpu, facets, leg);
    let mut pass = app.pass(&Scene::of(0, leg))?;
    let mut soak = Soak { rows: Vec::new(), complete: 0, last: Default::default() };
    let mut before = std::time::Instant::now();
    for frame in 0..frames {
        let scene = Scene::of(frame, leg);
        if frame > 0 && frame % leg == 0 {
            pass.set_casters(&scene.casters())?;
            pass.set_size(scene.size)?;
        }
        let status = app.frame(&mut pass, &scene, frame)?;
        if let Some(error) = status.error {
            return Err(Error::Gpu(error));
        }
        soak.complete += u64::from(status.complete);
        if (frame + 1) % every == 0 {
            let ms = before.elapsed().as_secs_f64() * 1e3 / every as f64;
            let row = Row { frame: frame + 1, resident: resident(), device: on_device(gpu), ms };
            told(&row);
            soak.rows.push(row);
            before = std::time::Instant::now();
        }
    }
    // The last frame once more, until it is complete; then the same of a fresh pass.
    let (frame, mut fresh) = (frames.max(1) - 1, app.pass(&Scene::of(frames.max(1) - 1, leg))?);
    for (pass, out) in [&mut pass, &mut fresh].into_iter().zip(&mut soak.last) {
        if !(0..9).map(|_| app.frame(pass, &Scene::of(frame, leg), frame)).any(|s| s.is_ok_and(|s| s.complete)) {
            return Err(Error::Gpu("the last frame is not complete".to_owned()));
        }
        *out = words(gpu, pass.visibility(), pass.lit())?;
    }
    Ok(soak)
}

/// Bytes that this process has in memory; 0 where the system does not tell.
fn resident() -> u64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// Bytes of all resources of a device; 0 where it does not tell.
fn on_device(gpu: &Gpu) -> u64 {
    gpu.device.generate_allocator_report().map_or(0, |report| report.total_allocated_bytes)
}
