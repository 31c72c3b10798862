//! Rows of reports and of experiments: measured, or taken from the journal of an earlier run.

use super::progress::Task;
use lab::report::comparison::pictures::{Panel, PanelCut, side_by_side};
use lab::report::comparison::{Journal, Machine, Measuring, ReportVariant, Row, SceneCase};
use lab::scene::Scene;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use subpixel_shadows::{Error, Result};

/// A scene with its rows.
pub struct Job<'a> {
    /// Options beside the scene's name that it is opened with: rows of others are not taken for its own.
    pub view: &'a str,
    /// Opens the scene.
    pub open: Box<dyn Fn() -> Result<Scene> + 'a>,
    /// How often its triangles are split into four.
    pub tessellation: u32,
    /// Its rows.
    pub variants: Vec<ReportVariant>,
    /// Samples of which the error that sampling leaves is stated.
    pub truths: Vec<ReportVariant>,
    /// Whether errors against 1024 rays a pixel are found, too.
    pub converged: bool,
    /// Pixels at its target by which the camera goes aside, one a frame, for flicker to be found; 0 for none.
    pub steps: u32,
    /// Pictures side by side.
    pub sheet: Option<JobSheet<'a>>,
}

/// Pictures of a job's rows.
pub struct JobSheet<'a> {
    /// The file.
    pub path: PathBuf,
    /// The part of each picture that is shown.
    pub cut: PanelCut,
    /// The rows that are on it.
    pub shown: Box<dyn Fn(&ReportVariant) -> bool + 'a>,
}

impl Job<'_> {
    /// Rows that it adds to a report.
    fn len(&self) -> usize {
        self.variants.len() + self.truths.len()
    }
}

/// A part of the rows of a run: every so many-th group that is measured together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowPart {
    /// Which, from 1 on.
    number: usize,
    /// Of how many.
    of: usize,
}

impl RowPart {
    /// All rows.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Whether it lacks rows of other parts.
    pub fn lacks(part: Option<Self>) -> bool {
        part.is_some_and(|part| part != Self::WHOLE)
    }

    /// Whether it is the first.
    pub fn is_first(self) -> bool {
        self.number == 1
    }

    /// Whether it has a group.
    fn takes(self, group: usize) -> bool {
        group % self.of + 1 == self.number
    }
}

impl FromStr for RowPart {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let refuse = || format!("'{text}' is no part such as 3/8");
        let (number, of) = text.split_once('/').ok_or_else(refuse)?;
        let [number, of] = [number, of].map(|n| n.parse::<usize>().ok());
        match (number, of) {
            (Some(number), Some(of)) if (1..=of).contains(&number) && of <= 10_000 => Ok(Self { number, of }),
            _ => Err(refuse()),
        }
    }
}

/// The journal of a folder; `fresh` begins it anew.
pub fn journal_of(out: &Path, fresh: bool, machine: &Machine) -> Result<Journal> {
    let at = out.join("rows.jsonl");
    if fresh && at.exists() {
        std::fs::remove_file(&at).map_err(|e| Error::file(&at, e.to_string()))?;
    }
    Journal::open(&at, machine)
}

/// The rows of many jobs, one after the other.
pub struct JobRows<'a> {
    /// How they are measured.
    bench: &'a Measuring<'a>,
    /// Rows that are known already, and that become known.
    journal: &'a mut Journal,
    /// The row that times are over.
    reference: ReportVariant,
    /// Which rows are measured, and how many groups came before.
    part: (RowPart, usize),
    /// Where progress is shown.
    task: &'a Task,
    /// Rows that are there, and in all.
    done: [usize; 2],
}

impl<'a> JobRows<'a> {
    /// The rows of all jobs, of a part those that are known; `reference` is the row that times are over.
    pub fn of_all(
        (bench, journal): (&'a Measuring<'a>, &'a mut Journal),
        reference: ReportVariant,
        part: Option<RowPart>,
        task: &'a Task,
        jobs: &[Job],
    ) -> Result<Vec<Row>> {
        let done = [0, jobs.iter().map(Job::len).sum()];
        let mut rows = Self { bench, journal, reference, part: (part.unwrap_or(RowPart::WHOLE), 0), task, done };
        let mut found = Vec::new();
        for job in jobs {
            found.extend(rows.of(job)?);
        }
        Ok(found)
    }

    /// The rows of a job, in order; those of truth last.
    fn of(&mut self, job: &Job) -> Result<Vec<Row>> {
        let size = self.reference.settings.size;
        let mut case = SceneCase::new((job.open)()?, job.tessellation, size)?;
        case.view = job.view.to_owned();
        let shown = |v: &ReportVariant| job.sheet.as_ref().is_some_and(|sheet| (sheet.shown)(v));
        let (part, before) = self.part;
        let whole = part == RowPart::WHOLE;
        let last = before + job.variants.len().div_ceil(Measuring::GROUP);
        self.part.1 = last + usize::from(!job.truths.is_empty());
        let groups = job.variants.chunks(Measuring::GROUP).enumerate().filter(|(k, _)| part.takes(before + k));
        let own = groups.flat_map(|(_, group)| group);
        let missing: Vec<ReportVariant> = own.filter(|v| !self.journal.has(&case.row(v).key())).cloned().collect();
        self.step(job.variants.len() - missing.len());
        // Of each variant that the picture shows what it rendered.
        let mut pictures: Vec<Option<Vec<f32>>> = vec![None; job.variants.len()];
        for group in missing.chunks(Measuring::GROUP) {
            let found = self.bench.measure(&case, &self.reference, group)?;
            let flicker = match job.steps {
                0 => vec![None; group.len()],
                steps => self.bench.flicker(&case, group, steps)?,
            };
            for ((variant, mut found), flicker) in group.iter().zip(found).zip(flicker) {
                if found.row.failed.is_none() {
                    found.row.flicker = flicker;
                    if job.converged {
                        (found.row.matched, found.row.converged) =
                            case.errors(&variant.settings, &found.visibility, None)?;
                    } else {
                        found.row.matched = case.matched_errors(&variant.settings, &found.visibility)?;
                    }
                    let place = job.variants.iter().position(|o| o == variant);
                    if let Some(n) = place.filter(|_| shown(variant)) {
                        pictures[n] = Some(found.visibility);
                    }
                }
                self.journal.add(found.row)?;
                self.step(1);
            }
        }
        if let Some(sheet) = &job.sheet
            && whole
            && (!sheet.path.exists() || pictures.iter().any(Option::is_some))
        {
            self.draw(&mut case, job, sheet, pictures)?;
        }
        let mut truths = Vec::new();
        for like in &job.truths {
            let key = Row { method: SceneCase::TRUTH.to_owned(), setting: String::new(), ..case.row(like) }.key();
            if !self.journal.has(&key) && part.takes(last) {
                self.journal.add(case.row_of_truth(&like.settings, None)?)?;
            }
            self.step(1);
            truths.extend(self.journal.get(&key).cloned());
        }
        let keys = job.variants.iter().map(|v| case.row(v).key());
        let mut found: Vec<Row> = keys.filter_map(|key| self.journal.get(&key).cloned()).collect();
        found.extend(truths);
        Ok(found)
    }

    /// Draws the pictures of a job with those of rows of former runs, and at last that of rays.
    fn draw(
        &self,
        case: &mut SceneCase,
        job: &Job,
        sheet: &JobSheet,
        mut pictures: Vec<Option<Vec<f32>>>,
    ) -> Result<()> {
        let mut panels = Vec::new();
        for (picture, variant) in pictures.iter_mut().zip(&job.variants).filter(|(_, v)| (sheet.shown)(v)) {
            let known = self.journal.get(&case.row(variant).key()).is_some_and(|r| r.failed.is_none());
            if picture.is_none() && known {
                *picture = self.bench.picture(case, variant)?;
            }
            if let Some(ours) = picture.take() {
                panels.push(Panel { ours, truth: case.matched(&variant.settings, None)?.visibility().to_vec() });
            }
        }
        if let Some(last) = panels.last().map(|panel| panel.truth.clone()) {
            panels.push(Panel { ours: last.clone(), truth: last });
            side_by_side(&sheet.path, self.reference.settings.size, sheet.cut, &panels)?;
        }
        Ok(())
    }

    fn step(&mut self, rows: usize) {
        self.done[0] += rows;
        self.task.at(self.done[0], self.done[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_take_every_group_once() {
        for of in [1, 2, 3, 8] {
            let parts: Vec<RowPart> = (1..=of).map(|k| format!("{k}/{of}").parse().unwrap()).collect();
            for group in 0..40 {
                assert_eq!(parts.iter().filter(|part| part.takes(group)).count(), 1, "group {group} of {of} parts");
            }
        }
        assert_eq!("1/1".parse(), Ok(RowPart::WHOLE));
        for text in ["", "3", "0/4", "5/4", "a/b", "1/0", "-1/2", "1/2/3", "1/100000"] {
            assert!(text.parse::<RowPart>().is_err_and(|e| e.contains(text)), "{text}");
        }
    }
}
