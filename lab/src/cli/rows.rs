//! Rows of reports and of experiments: measured, or taken from the journal of an earlier run.

use super::progress::Task;
use lab::report::comparison::pictures::{Cut, Panel, side_by_side};
use lab::report::comparison::{Journal, Measuring, ReportVariant, Row, SceneCase};
use lab::scene::Scene;
use std::path::PathBuf;
use subpixel_shadows::Result;

/// A scene with its rows.
pub struct Job<'a> {
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
    /// Pictures side by side.
    pub sheet: Option<JobSheet<'a>>,
}

/// Pictures of a job's rows.
pub struct JobSheet<'a> {
    /// The file.
    pub path: PathBuf,
    /// What is shown of each picture.
    pub cut: Cut,
    /// The rows that are on it.
    pub shown: Box<dyn Fn(&ReportVariant) -> bool + 'a>,
}

impl Job<'_> {
    /// Rows that it adds to a report.
    pub fn len(&self) -> usize {
        self.variants.len() + self.truths.len()
    }
}

/// The rows of many jobs, one after the other.
pub struct Rows<'a> {
    /// How they are measured.
    pub bench: &'a Measuring<'a>,
    /// What is known already, and what becomes known.
    pub journal: &'a mut Journal,
    /// The row that times are over.
    pub reference: ReportVariant,
    /// Where progress is shown.
    pub task: &'a Task,
    /// Rows that are there.
    pub done: usize,
    /// Rows in all.
    pub all: usize,
}

impl Rows<'_> {
    /// The rows of a job, in order; those of truth last.
    pub fn of(&mut self, job: &Job) -> Result<Vec<Row>> {
        let size = self.reference.settings.size;
        let mut case = SceneCase::new((job.open)()?, job.tessellation, size)?;
        let shown = |v: &ReportVariant| job.sheet.as_ref().is_some_and(|sheet| (sheet.shown)(v));
        let missing: Vec<ReportVariant> =
            job.variants.iter().filter(|v| !self.journal.has(&case.row(v).key())).cloned().collect();
        self.step(job.variants.len() - missing.len());
        // Of each variant that the picture shows what it rendered.
        let mut pictures: Vec<Option<Vec<f32>>> = vec![None; job.variants.len()];
        for group in missing.chunks(Measuring::GROUP) {
            for (variant, mut found) in group.iter().zip(self.bench.measure(&case, &self.reference, group)?) {
                if found.row.failed.is_none() {
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
            && (!sheet.path.exists() || pictures.iter().any(Option::is_some))
        {
            self.draw(&mut case, job, sheet, pictures)?;
        }
        let mut truths = Vec::new();
        for like in &job.truths {
            let key = Row { method: SceneCase::TRUTH.to_owned(), setting: String::new(), ..case.row(like) }.key();
            if !self.journal.has(&key) {
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
        self.done += rows;
        self.task.at(self.done, self.all);
    }
}
