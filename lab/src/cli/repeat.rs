//! Times that a frame takes once it is set up.

use lab::report::comparison::Spread;
use std::time::{Duration, Instant};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::StageTime;
use subpixel_shadows::render::Output;

/// When no further frame is begun, counted from the begin of the first that is timed.
const PATIENCE: Duration = Duration::from_secs(5);

/// `first` with the times of the frames after it, the median of each, and how many these are: `frames`, or as many as begin within
/// [`PATIENCE`], but one at the least. The first frame, whose own times are dropped, compiles what the driver has not compiled yet,
/// touches memory for the first time, and finds how long the lists have to be. Without `frames` no time is taken.
pub fn timed(first: Output, frames: u32, mut again: impl FnMut() -> Result<Output>) -> Result<(Output, u32)> {
    let (start, mut later) = (Instant::now(), Vec::new());
    while later.len() < frames as usize && (later.is_empty() || start.elapsed() < PATIENCE) {
        let Output { stages, wall_ms, .. } = again()?;
        later.push((stages, wall_ms));
    }
    let median = |values: Vec<f64>| Spread::of(&values).median;
    let stages = later.first().map_or(&[][..], |(stages, _)| stages);
    let of_stage = |k: usize| later.iter().filter_map(|(stages, _)| Some(stages.get(k)?.gpu_ms)).collect();
    let stages = (0..stages.len()).map(|k| StageTime { name: stages[k].name, gpu_ms: median(of_stage(k)) }).collect();
    let wall_ms = median(later.iter().map(|(_, wall)| *wall).collect());
    Ok((Output { stages, wall_ms, ..first }, later.len() as u32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::methods::facet_masks::Settings;
    use subpixel_shadows::samples::{Pattern, Samples};

    fn frame(ms: f64) -> Output {
        let settings = Settings::new([2, 2], 4, Samples::new(Pattern::Grid, 1).unwrap());
        let stages = ["resolve", "triangle_setup"].map(|name| StageTime { name, gpu_ms: ms }).to_vec();
        Output { stages, wall_ms: ms, dispatches: 7, ..Output::nothing_seen(&settings) }
    }

    #[test]
    fn times_are_medians_of_the_frames_after_the_first() {
        let mut later = [30.0, 10.0, 20.0].into_iter();
        let (output, counted) = timed(frame(90.0), 3, || Ok(frame(later.next().unwrap()))).unwrap();
        assert_eq!((counted, output.wall_ms, output.dispatches), (3, 20.0, 7));
        let times: Vec<_> = output.stages.iter().map(|s| (s.name, s.gpu_ms)).collect();
        assert_eq!(times, [("resolve", 20.0), ("triangle_setup", 20.0)]);
    }

    #[test]
    fn the_first_frame_is_never_timed_whatever_it_takes() {
        for (ms, frames) in [(90.0, 1), (6000.0, 1), (6000.0, 3)] {
            let (output, counted) = timed(frame(ms), frames, || Ok(frame(20.0))).unwrap();
            assert_eq!((counted, output.wall_ms, output.stages[0].gpu_ms), (frames, 20.0, 20.0));
        }
        let (output, counted) = timed(frame(90.0), 0, || panic!("no other frame is asked for")).unwrap();
        assert!(counted == 0 && output.wall_ms == 0.0 && output.stages.is_empty() && output.dispatches == 7);
    }

    #[test]
    fn long_frames_are_few_and_one_at_the_least() {
        let slow = || {
            std::thread::sleep(PATIENCE + Duration::from_millis(1));
            Ok(frame(20.0))
        };
        assert_eq!(timed(frame(90.0), 3, slow).unwrap().1, 1);
    }
}
