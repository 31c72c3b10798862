//! Plots as SVG: points and lines over two axes.

use crate::report::picture;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use std::ops::Range;
use std::path::Path;
use subpixel_shadows::{Error, Result};

/// An axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Whether it is logarithmic.
    pub log: bool,
}

impl Axis {
    /// A logarithmic axis.
    pub fn log(label: &str) -> Self {
        Self { label: label.to_owned(), log: true }
    }

    /// A linear axis from 0.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), log: false }
    }
}

/// Points of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Places, each with a short text beside it (which may be empty).
    pub points: Vec<(f64, f64, String)>,
    /// Whether points are joined.
    pub joined: bool,
    /// Drawn as a broad grey line without marks: a bound or a front.
    pub guide: bool,
}

/// A plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Its title.
    pub title: String,
    /// The axis from left to right.
    pub x: Axis,
    /// The axis from the bottom up.
    pub y: Axis,
    /// Series that are drawn.
    pub series: Vec<Series>,
}

/// Colours that people with any colour vision can tell apart (Okabe and Ito 2008), black last.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(120, 80, 40),
    RGBColor(0, 0, 0),
];
const SIZE: (u32, u32) = (1120, 600);
/// Where the legend begins.
const LEGEND: i32 = 820;

impl Plot {
    /// Writes the plot. Points that a logarithmic axis cannot show are left out; a plot without points has no file.
    ///
    /// # Errors
    /// [`Error::File`] naming `path` if it cannot be written.
    pub fn write(&self, path: &Path) -> Result<bool> {
        let shown = Self { series: self.series.iter().map(|s| self.shown(s)).collect(), ..self.clone() };
        if shown.series.iter().all(|s| s.points.is_empty()) {
            return Ok(false);
        }
        let mut text = String::new();
        let fault = |e: String| Error::file(path, e);
        {
            let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            shown.draw(&area).map_err(fault)?;
            area.present().map_err(|e| fault(e.to_string()))?;
        }
        picture::write(path, |out| Ok(std::io::Write::write_all(out, text.as_bytes())?))?;
        Ok(true)
    }

    fn shown(&self, series: &Series) -> Series {
        let fits = |axis: &Axis, v: f64| v.is_finite() && (!axis.log || v > 0.0);
        let points = series.points.iter().filter(|(x, y, _)| fits(&self.x, *x) && fits(&self.y, *y));
        Series { points: points.cloned().collect(), ..series.clone() }
    }

    fn draw(&self, area: &DrawingArea<SVGBackend, Shift>) -> std::result::Result<(), String> {
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        let (area, legend) = area.split_horizontally(LEGEND);
        let all = || self.series.iter().flat_map(|s| &s.points);
        let (x, y) = (self.x.ticks(all().map(|p| p.0)), self.y.ticks(all().map(|p| p.1)));
        let place = |p: &(f64, f64, String)| (self.x.place(p.0), self.y.place(p.1));
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, ("sans-serif", 20))
            .margin(14)
            .x_label_area_size(46)
            .y_label_area_size(70)
            .build_cartesian_2d(Scale { ticks: x, log: self.x.log }, Scale { ticks: y, log: self.y.log })
            .map_err(|e| e.to_string())?;
        chart
            .configure_mesh()
            .x_labels(40)
            .y_labels(40)
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .label_style(("sans-serif", 14))
            .bold_line_style(RGBColor(225, 225, 225))
            .light_line_style(TRANSPARENT)
            .draw()
            .map_err(|e| e.to_string())?;
        let mut colours = COLOURS.iter().cycle();
        let guides = self.series.iter().filter(|s| s.guide).count();
        for (n, series) in self.series.iter().enumerate() {
            let at = 60 + 20 * n as i32;
            let name = Text::new(series.name.clone(), (30, at - 6), ("sans-serif", 13));
            legend.draw(&name).map_err(|e| e.to_string())?;
            if series.guide {
                let style = RGBColor(150, 150, 150).mix(0.4).stroke_width(7);
                let line = LineSeries::new(series.points.iter().map(place), style);
                chart.draw_series(line).map_err(|e| e.to_string())?;
                legend.draw(&PathElement::new([(4, at), (22, at)], style)).map_err(|e| e.to_string())?;
                continue;
            }
            let colour = *colours.next().unwrap_or(&BLACK);
            if series.joined {
                let line = LineSeries::new(series.points.iter().map(place), colour.mix(0.7).stroke_width(1));
                chart.draw_series(line).map_err(|e| e.to_string())?;
            }
            // Beyond as many series as there are colours rings, beyond twice as many triangles.
            let points = series.points.iter().map(place);
            if n < 2 * COLOURS.len() + guides {
                let mark = if n >= COLOURS.len() + guides { colour.stroke_width(2) } else { colour.filled() };
                chart.draw_series(points.map(|p| Circle::new(p, 4, mark))).map_err(|e| e.to_string())?;
                legend.draw(&Circle::new((13, at), 4, mark)).map_err(|e| e.to_string())?;
            } else {
                let mark = |p| TriangleMarker::new(p, 5, colour.filled());
                chart.draw_series(points.map(mark)).map_err(|e| e.to_string())?;
                legend.draw(&TriangleMarker::new((13, at), 5, colour.filled())).map_err(|e| e.to_string())?;
            }
            let font = ("sans-serif", 12).into_font().color(&colour);
            let named = series.points.iter().filter(|p| !p.2.is_empty());
            let texts = named.map(|p| EmptyElement::at(place(p)) + Text::new(p.2.clone(), (6, -12), font.clone()));
            chart.draw_series(texts).map_err(|e| e.to_string())?;
        }
        Ok(())
    }
}

impl Axis {
    /// Where a value lies on the axis.
    fn place(&self, v: f64) -> f64 {
        if self.log { v.log10() } else { v }
    }

    /// Places of the marks of an axis that holds these values, the ends of the axis first and last.
    fn ticks(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let (low, high) =
            values.map(|v| self.place(v)).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if !self.log {
            let step = step_above(high.max(1e-9) / 8.0);
            return (0..=(high.max(1e-9) * 1.02 / step).ceil() as u32).map(|k| f64::from(k) * step).collect();
        }
        // 1, 2 and 5 times the powers of ten, or the powers alone where there are many.
        let parts: &[f64] = if high - low > 4.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let (first, last) = ((low - 0.02).floor() as i32, (high + 0.02).floor() as i32 + 1);
        let all: Vec<f64> = (first..=last).flat_map(|k| parts.iter().map(move |p| f64::from(k) + p.log10())).collect();
        let from = all.iter().rposition(|v| *v <= low - 0.02).unwrap_or(0);
        let to = all.iter().position(|v| *v >= high + 0.02).unwrap_or(all.len() - 1);
        all[from..=to].to_vec()
    }
}

/// An axis with marks of our own.
struct Scale {
    ticks: Vec<f64>,
    log: bool,
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let Range { start, end } = ends(&self.ticks);
        limit.0 + ((value - start) / (end - start) * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, _: H) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        ends(&self.ticks)
    }
}

impl ValueFormatter<f64> for Scale {
    fn format(place: &f64) -> String {
        short(*place)
    }

    fn format_ext(&self, place: &f64) -> String {
        short(if self.log { 10f64.powf(*place) } else { *place })
    }
}

fn ends(ticks: &[f64]) -> Range<f64> {
    ticks.first().copied().unwrap_or(0.0)..ticks.last().copied().unwrap_or(1.0)
}

/// The least of 1, 2 and 5 times a power of ten that is not below `v`.
fn step_above(v: f64) -> f64 {
    let power = 10f64.powf(v.log10().floor());
    [1.0, 2.0, 5.0].iter().map(|m| m * power).find(|s| *s >= v).unwrap_or(10.0 * power)
}

/// A number on an axis: three digits, powers of ten where it is far from 1.
fn short(v: f64) -> String {
    let size = v.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{v:.0e}");
    }
    let text = format!("{v:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_every_point_that_fits_and_names_each_series() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-plot-{}.svg", std::process::id()));
        let of = |name: &str, points: &[(f64, f64)]| Series {
            name: name.to_owned(),
            points: points.iter().map(|&(x, y)| (x, y, format!("at {x}"))).collect(),
            joined: true,
            guide: false,
        };
        let series = vec![of("first", &[(1.0, 2.0), (10.0, 0.0)]), of("second", &[(100.0, 0.001)])];
        for (x, y, shown) in [
            (Axis::log("time"), Axis::log("error"), 2),
            (Axis::log("time"), Axis::linear("error"), 3),
            (Axis::linear("time"), Axis::log("error"), 2),
            (Axis::linear("time"), Axis::linear("error"), 3),
        ] {
            let plot = Plot { title: "a title".to_owned(), x, y, series: series.clone() };
            assert!(plot.write(&path).unwrap());
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(text.contains("a title") && text.contains("first") && text.contains("second"));
            assert_eq!(text.matches("at 1").count(), shown);
        }
        let empty = Plot { title: String::new(), x: Axis::log(""), y: Axis::log(""), series: Vec::new() };
        std::fs::remove_file(&path).unwrap();
        assert!(!empty.write(&path).unwrap() && !path.exists());
    }

    /// Of 24 series no two have the same mark.
    #[test]
    fn every_series_has_a_mark_of_its_own() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-marks-{}.svg", std::process::id()));
        let of = |k: u32| Series {
            name: format!("series {k}"),
            points: vec![(f64::from(k + 1), 1.0, String::new())],
            joined: false,
            guide: false,
        };
        let series = (0..24).map(of).collect();
        let plot = Plot { title: String::new(), x: Axis::log("time"), y: Axis::log("error"), series };
        assert!(plot.write(&path).unwrap());
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        // Without the places; each is drawn at its point and in the legend.
        let is_style = |attribute: &&str| ["fill", "stroke"].iter().any(|style| attribute.starts_with(style));
        let marks = text.lines().filter(|line| line.starts_with("<circle") || line.starts_with("<polygon"));
        let kind = |line: &str| {
            let styles: Vec<String> = line.split(' ').filter(is_style).map(str::to_owned).collect();
            (line.starts_with("<circle"), styles)
        };
        let kinds: Vec<_> = marks.map(kind).collect();
        assert_eq!(kinds.len(), 48);
        let different: std::collections::BTreeSet<_> = kinds.iter().collect();
        assert_eq!(different.len(), 24, "{different:?}");
    }

    #[test]
    fn marks_enclose_what_is_shown() {
        let log = Axis::log("");
        for (low, high) in [(26.0, 46.0), (100.0, 100.0), (0.03, 0.19), (1.0, 1e6), (1e-7, 5.0)] {
            let ticks = log.ticks([low, high].into_iter());
            let (first, last) = (10f64.powf(ticks[0]), 10f64.powf(ticks[ticks.len() - 1]));
            assert!(first < low && last > high && ticks.len() >= 2, "{low} {high}: {ticks:?}");
            assert!(first > low / 11.0 && last < high * 11.0 && ticks.len() < 16, "{low} {high}: {ticks:?}");
        }
        let ticks = Axis::linear("").ticks([3.0, 128.0].into_iter());
        assert!(ticks[0] == 0.0 && ends(&ticks).end >= 128.0 && ticks.len() < 12, "{ticks:?}");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, 1.0, 0.25, 1500.0, 1e7, 1e-5].map(short), ["0", "1", "0.25", "1500", "1e7", "1e-5"]);
    }
}
