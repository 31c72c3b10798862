//! The experiments of the papers, each measured again by one command: `report figure NAME`.
//!
//! An experiment is a list of rows on some scenes, what the paper found, and what is shown of the rows. Its rows are written as `render` takes
//! them, so that each can be rendered by itself.

mod bondarev;
mod columns;
mod lecocq;
mod oliveira;
mod page;
mod pan;
mod scherzer;
mod views;

pub use page::{command_of, markdown};
pub use views::views_file;

use crate::options::FrameArguments;
use crate::report::comparison::plots::Plot;
use crate::report::comparison::{ReportVariant, Row};
use crate::scene::Scene;
use subpixel_shadows::Result;

/// A scene of an experiment, seen and lit in one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its name in tables and plots.
    pub label: &'static str,
    /// The scene, as `render` takes it.
    pub scene: &'static str,
    /// Options of `render` beside it: ground, camera, light.
    pub options: &'static str,
}

impl Place {
    /// A scene as it is.
    pub const fn of(scene: &'static str) -> Self {
        Self { label: scene, scene, options: "" }
    }
}

/// Pictures of all rows of a scene side by side, below each its difference from rays through the same samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloseUp {
    /// The part of the image: left, top, width and height as shares of it.
    pub part: [f32; 4],
    /// Pixels of the sheet to one of the image.
    pub zoom: u32,
    /// Factor of differences.
    pub gain: f32,
}

/// Something that is said of the rows: a heading, and a table below it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// One line above it.
    pub title: String,
    /// Names of the columns.
    pub head: Vec<&'static str>,
    /// The lines.
    pub lines: Vec<Vec<String>>,
}

/// An experiment of a paper.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Its name on the command line.
    pub name: &'static str,
    /// The paper, and the figure or table.
    pub source: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The finding of the paper, with its figures.
    pub shows: &'static str,
    /// Why what is measured here differs.
    pub differs: &'static str,
    /// Where it is made.
    pub places: &'static [Place],
    /// Method and options of each row, such as `spsm encoding=paper`.
    pub rows: &'static [&'static str],
    /// Samples a pixel; every row is measured with each.
    pub samples: &'static [u32],
    /// Sizes of the map; every row is measured with each.
    pub maps: &'static [u32],
    /// Times that each triangle is also split into four.
    pub tessellation: u32,
    /// Whether errors against 1024 rays a pixel are found, too.
    pub converged: bool,
    /// The label of a place where flicker is found, too, and by how many pixels at its target the camera goes aside for that, one a frame.
    pub moves: Option<(&'static str, u32)>,
    /// Pictures.
    pub sheet: Option<CloseUp>,
    /// Whether pictures tell which view of the light each pixel asks.
    pub views: bool,
    /// Its tables.
    pub tables: fn(&[&Row]) -> Vec<Table>,
    /// Its plots, each with the name of its file.
    pub plots: fn(&[&Row]) -> Vec<(&'static str, Plot)>,
}

/// An experiment of which only what most have is known: 8 samples a pixel, and a map of 512 x 512.
const PLAIN: Experiment = Experiment {
    name: "",
    source: "",
    title: "",
    shows: "",
    differs: "",
    places: &[],
    rows: &[],
    samples: &[8],
    maps: &[512],
    tessellation: 0,
    converged: false,
    moves: None,
    sheet: None,
    views: false,
    tables: |_| Vec::new(),
    plots: |_| Vec::new(),
};

/// All experiments, paper by paper.
pub const EXPERIMENTS: [&[Experiment]; 5] = [&pan::ALL, &lecocq::ALL, &bondarev::ALL, &oliveira::ALL, &scherzer::ALL];

/// All experiments.
pub fn experiments() -> impl Iterator<Item = &'static Experiment> {
    EXPERIMENTS.into_iter().flatten()
}

/// The experiment of a name, for the command line.
///
/// # Errors
/// A line with all names.
pub fn experiment(name: &str) -> std::result::Result<&'static Experiment, String> {
    experiments().find(|e| e.name == name).ok_or_else(|| {
        let names: Vec<&str> = experiments().map(|e| e.name).collect();
        format!("no figure '{name}'; there are {}", names.join(", "))
    })
}

impl Experiment {
    /// Opens the scene of a place, named by its label.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn open(place: &Place) -> Result<Scene> {
        let FrameArguments { scene, options } =
            FrameArguments::of_line(&format!("render {} {}", place.scene, place.options))?;
        let (scene, _) = options.open(scene.as_deref())?;
        Ok(Scene { name: place.label.to_owned(), ..scene })
    }

    /// Its rows on each scene, those of one map and number of samples one after the other.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Config`] for an image that cannot be.
    pub fn variants(&self, size: [u32; 2]) -> Result<Vec<ReportVariant>> {
        let mut found = Vec::new();
        for map in self.maps {
            for samples in self.samples {
                for row in self.rows {
                    found.push(variant(row, *samples, *map, size)?);
                }
            }
        }
        Ok(found)
    }

    /// Rows scene by scene, each as they are measured, whatever order they were.
    ///
    /// # Errors
    /// As [`Experiment::variants`].
    pub fn in_order(&self, rows: &[Row]) -> Result<Vec<Row>> {
        let all = self.variants(rows.first().map_or([1; 2], |r| r.size))?;
        let place = |row: &Row| {
            let scene = self.places.iter().position(|place| place.label == row.scene);
            (scene, row.tessellation, all.iter().position(|v| v.made(row)))
        };
        let mut sorted = rows.to_vec();
        sorted.sort_by_key(place);
        Ok(sorted)
    }

    /// The row that ratios of time are over: `facet-masks` with one facet a pixel, at the first number of samples and map.
    ///
    /// # Errors
    /// As [`Experiment::variants`].
    pub fn reference(&self, size: [u32; 2]) -> Result<ReportVariant> {
        variant("facet-masks facets=one", self.samples[0], self.maps[0], size)
    }
}

/// The variant of a method with options, such as `spsm encoding=paper`.
fn variant(row: &str, samples: u32, map: u32, [w, h]: [u32; 2]) -> Result<ReportVariant> {
    let (method, setting) = row.split_once(' ').unwrap_or((row, ""));
    let mut line = format!("render --method {method} --samples {samples} --map {map} --size {w}x{h}");
    for (option, value) in setting.split_whitespace().filter_map(|part| part.split_once('=')) {
        line += &format!(" --{option} {value}");
    }
    let options = FrameArguments::of_line(&line)?.options;
    Ok(ReportVariant { method: options.method, setting: setting.to_owned(), settings: options.settings()? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_experiment_can_be_asked_for() {
        let mut names = BTreeSet::new();
        for e in experiments() {
            assert!(names.insert(e.name), "{} twice", e.name);
            assert_eq!(experiment(e.name).map(|found| found.name), Ok(e.name));
            assert!(!e.places.is_empty() && !e.rows.is_empty() && !e.samples.is_empty() && !e.maps.is_empty());
            assert!(e.name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{}", e.name);
            let rows = e.variants([64, 48]).expect(e.name);
            assert_eq!(rows.len(), e.rows.len() * e.samples.len() * e.maps.len());
            for (k, row) in rows.iter().enumerate() {
                assert!(!rows[..k].contains(row), "{}: {row:?} twice", e.name);
                for part in row.setting.split_whitespace() {
                    let (option, _) = part.split_once('=').expect("option=value");
                    assert!(row.method.takes(option), "{}: {} takes no --{option}", e.name, row.method.name());
                }
            }
            let labels: BTreeSet<&str> = e.places.iter().map(|p| p.label).collect();
            assert_eq!(labels.len(), e.places.len(), "{}", e.name);
        }
        let refused = experiment("pan-0").expect_err("there is none");
        assert!(refused.contains("pan-10") && refused.lines().count() == 1, "{refused}");
    }

    /// Tables and plots are made of every row there is, and of none.
    #[test]
    fn tables_and_plots_are_made_of_any_rows() {
        for e in experiments() {
            let rows: Vec<Row> = e
                .places
                .iter()
                .flat_map(|place| e.variants([64, 48]).expect(e.name).into_iter().map(move |v| (place, v)))
                .map(|(place, v)| Row {
                    scene: place.label.to_owned(),
                    size: [64, 48],
                    map: v.settings.map,
                    samples: v.settings.samples.count(),
                    method: v.method.name().to_owned(),
                    setting: v.setting,
                    ratio: 1.0,
                    ..Row::default()
                })
                .collect();
            let all: Vec<&Row> = rows.iter().collect();
            for rows in [&all[..], &[]] {
                let tables = (e.tables)(rows);
                for table in &tables {
                    assert!(table.lines.iter().all(|line| line.len() == table.head.len()), "{}: {table:?}", e.name);
                }
                assert!(rows.is_empty() || tables.iter().any(|t| !t.lines.is_empty()), "{} shows nothing", e.name);
                (e.plots)(rows);
            }
        }
    }
}
