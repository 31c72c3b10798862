//! Going through cases: the GPU renders one while another is judged on the CPU.

use super::summary::Failure;
use super::{Fault, FuzzCase, FuzzDevice, Shot, Summary, Verdict, files, judge, shrink};
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel, sync_channel};
use std::time::{Duration, Instant};
use subpixel_shadows::{Error, Result};

/// Cases to run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The seed.
    pub seed: u64,
    /// The first case.
    pub first: u64,
    /// How many cases.
    pub cases: u64,
    /// When no further case is begun.
    pub patience: Option<Duration>,
    /// Where failing cases are written; nowhere: they are not shrunk either.
    pub out: Option<PathBuf>,
    /// How long one case is shrunk.
    pub shrink: Duration,
}

impl Run {
    /// Failures with the same fault that are shrunk and written; later ones are listed.
    pub const WRITTEN: usize = 5;
}

/// Messages along the way.
pub enum FuzzProgress<'a> {
    /// So many cases of so many are judged.
    Done(u64, u64),
    /// A case failed, and was shrunk and written if there is a command.
    Failed(&'a Failure),
}

/// A case on its way from one thread to the other.
type Rendered = (FuzzCase, Result<Shot>);
type Judged = (FuzzCase, Result<Verdict>);

/// Runs the cases; tells of them in their order.
///
/// # Errors
/// [`Error::Gpu`] with the case if the device fails, [`Error::File`] if a failing case cannot be written.
pub fn run(bench: &FuzzDevice, run: &Run, tell: &mut dyn FnMut(FuzzProgress)) -> Result<Summary> {
    let (start, mut summary, mut shrinking) = (Instant::now(), Summary::default(), Duration::ZERO);
    let mut written: HashMap<Fault, usize> = HashMap::new();
    let (to_judge, shots) = sync_channel::<Rendered>(2);
    let (to_us, verdicts) = channel::<Judged>();
    std::thread::scope(|scope| -> Result<()> {
        scope.spawn(move || judge_all(&shots, &to_us));
        let mut take = |judged: Judged| -> Result<()> {
            let begin = Instant::now();
            if let Some(failure) = settle(bench, run, &mut summary, judged, &mut written)? {
                shrinking += begin.elapsed();
                tell(FuzzProgress::Failed(&failure));
                summary.failures.push(failure);
            }
            tell(FuzzProgress::Done(summary.all().cases, run.cases));
            Ok(())
        };
        // Moved in, so that it closes when no case is left, also after an error.
        let to_judge = to_judge;
        for number in run.first..run.first.saturating_add(run.cases) {
            if run.patience.is_some_and(|patience| start.elapsed() >= patience) {
                break;
            }
            let case = FuzzCase::of(run.seed, number)?;
            let shot = render(bench, &case);
            if let Err(Error::Gpu(text)) = &shot {
                return Err(Error::Gpu(format!("case {number} of seed {}: {text}", run.seed)));
            }
            verdicts.try_iter().try_for_each(&mut take)?;
            let ended = |_| Error::Config("judging has ended early".to_owned());
            to_judge.send((case, shot)).map_err(ended)?;
        }
        drop(to_judge);
        verdicts.iter().try_for_each(&mut take)
    })?;
    summary.seconds = (start.elapsed().saturating_sub(shrinking)).as_secs_f64();
    Ok(summary)
}

fn judge_all(shots: &Receiver<Rendered>, to: &Sender<Judged>) {
    for (case, shot) in shots {
        let verdict = shot.map(|shot| judged(&case, &shot));
        if to.send((case, verdict)).is_err() {
            break;
        }
    }
}

/// Renders; a panic comes back as the name of a fault.
fn render(bench: &FuzzDevice, case: &FuzzCase) -> Result<Shot> {
    let done = catch_unwind(AssertUnwindSafe(|| bench.render(case)));
    done.unwrap_or_else(|_| Err(Error::Config(PANIC.to_owned())))
}

/// The reason of a case that panicked while it was rendered.
const PANIC: &str = "panicked while rendering";

/// Judges a rendered frame. An error of truth or the CPU engine is a fault, and so is a panic.
fn judged(case: &FuzzCase, shot: &Shot) -> Verdict {
    match catch_unwind(AssertUnwindSafe(|| judge(case, shot))) {
        Ok(Ok(verdict)) => verdict,
        Ok(Err(error)) => fault(Fault::Refused, error.to_string()),
        Err(_) => fault(Fault::Panic, "while judging".to_owned()),
    }
}

fn fault(fault: Fault, at: String) -> Verdict {
    Verdict { faults: vec![(fault, 1, at)], ..Verdict::default() }
}

/// Renders and judges, in one go.
///
/// # Errors
/// As [`FuzzDevice::render`].
pub fn verdict(bench: &FuzzDevice, case: &FuzzCase) -> Result<Verdict> {
    match render(bench, case) {
        Err(Error::Config(text)) if text == PANIC => Ok(fault(Fault::Panic, text)),
        shot => shot.map(|shot| judged(case, &shot)),
    }
}

/// Counts a case; shrinks and writes it if it failed.
fn settle(
    bench: &FuzzDevice,
    run: &Run,
    summary: &mut Summary,
    (case, verdict): Judged,
    written: &mut HashMap<Fault, usize>,
) -> Result<Option<Failure>> {
    let verdict = match verdict {
        Ok(verdict) => verdict,
        Err(Error::Config(text)) if text == PANIC => fault(Fault::Panic, text),
        Err(error) => {
            summary.refused(&case, &error.to_string());
            return Ok(None);
        }
    };
    summary.judged(&case, &verdict);
    let Some((first, ..)) = verdict.faults.first() else { return Ok(None) };
    let mut failure =
        Failure { case: [case.seed, case.number], kind: case.kind, faults: verdict.faults.clone(), repeat: None };
    let before = written.entry(*first).or_default();
    let Some(out) = run.out.as_ref().filter(|_| *before < Run::WRITTEN) else { return Ok(Some(failure)) };
    *before += 1;
    let mut fails = |smaller: &FuzzCase| self::verdict(bench, smaller).is_ok_and(|v| v.has(*first));
    let small = shrink::shrink(&case, run.shrink, &mut fails);
    let faults = self::verdict(bench, &small)?.faults;
    let folder = out.join(format!("case-{}-{}", case.seed, case.number));
    let command = files::write(&folder, &small, &faults)?;
    let size = small.how.settings.pixels() as u64;
    failure.repeat = Some((command, [small.world.mesh.triangles.len() as u64, size]));
    Ok(Some(failure))
}
