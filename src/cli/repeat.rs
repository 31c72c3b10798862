//! Times that a frame takes when it is not the first.

use std::time::{Duration, Instant};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::StageTime;
use subpixel_shadows::methods::render::Output;
use subpixel_shadows::report::comparison::Spread;

/// When no further frame is begun, counted from the begin of the first.
const PATIENCE: Duration = Duration::from_secs(5);

/// `first` with the times of the frames after it, the median of each, and how many these are: one fewer than `frames`, or as many as
/// begin within [`PATIENCE`]; none after a first that took longer. A first frame also pays for memory that was never touched, and for lists that turned out too short.
pub fn warm(first: Output, frames: u32, mut again: impl FnMut() -> Result<Output>) -> Result<(Output, u32)> {
    let (start, of_first) = (Instant::now(), Duration::from_secs_f64(first.wall_ms.max(0.0) / 1e3));
    let mut later = Vec::new();
    while later.len() + 1 < frames as usize && start.elapsed() + of_first < PATIENCE {
        let Output { stages, wall_ms, .. } = again()?;
        later.push((stages, wall_ms));
    }
    let Some((stages, _)) = later.first() else { return Ok((first, 0)) };
    let median = |values: Vec<f64>| Spread::of(&values).median;
    let of_stage = |k: usize| later.iter().filter_map(|(stages, _)| Some(stages.get(k)?.gpu_ms)).collect();
    let stages = (0..stages.len()).map(|k| StageTime { name: stages[k].name, gpu_ms: median(of_stage(k)) }).collect();
    let wall_ms = median(later.iter().map(|(_, wall)| *wall).collect());
    Ok((Output { stages, wall_ms, ..first }, later.len() as u32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::methods::facet_masks::Settings;
    use subpixel_shadows::methods::unshadowed;
    use subpixel_shadows::samples::{Pattern, Samples};

    fn frame(ms: f64) -> Output {
        let settings = Settings::new([2, 2], 4, Samples::new(Pattern::Grid, 1).unwrap());
        let stages = ["resolve", "triangle_setup"].map(|name| StageTime { name, gpu_ms: ms }).to_vec();
        Output { stages, wall_ms: ms, dispatches: 7, ..unshadowed::nothing_seen(&settings) }
    }

    #[test]
    fn times_are_medians_of_the_frames_after_the_first() {
        let mut later = [30.0, 10.0, 20.0].into_iter();
        let (output, counted) = warm(frame(90.0), 4, || Ok(frame(later.next().unwrap()))).unwrap();
        assert_eq!((counted, output.wall_ms, output.dispatches), (3, 20.0, 7));
        let times: Vec<_> = output.stages.iter().map(|s| (s.name, s.gpu_ms)).collect();
        assert_eq!(times, [("resolve", 20.0), ("triangle_setup", 20.0)]);
    }

    #[test]
    fn of_one_frame_or_a_long_one_the_time_is_its_own() {
        for (ms, frames) in [(90.0, 1), (6000.0, 4)] {
            let (output, counted) = warm(frame(ms), frames, || panic!("no other frame is asked for")).unwrap();
            assert_eq!((counted, output.wall_ms, output.stages[0].gpu_ms), (0, ms, ms));
        }
    }
}
