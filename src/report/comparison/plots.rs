//! Plots as SVG: points and lines over two axes.

use crate::report::picture;
use crate::{Error, Result};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;
use std::path::Path;

/// An axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// What it shows, with its unit.
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
    /// Drawn as a thin grey line without marks: a bound or a front.
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
    /// What is shown.
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
const SIZE: (u32, u32) = (960, 600);

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

    fn range(&self, of: impl Fn(&(f64, f64, String)) -> f64, axis: &Axis) -> Range<f64> {
        let values = || self.series.iter().flat_map(|s| &s.points).map(&of);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if axis.log { low / 1.4..high * 1.6 } else { 0.0_f64.min(low)..high.max(1e-12) * 1.08 }
    }

    fn draw(&self, area: &DrawingArea<SVGBackend, Shift>) -> std::result::Result<(), String> {
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        let (x, y) = (self.range(|p| p.0, &self.x), self.range(|p| p.1, &self.y));
        // Four kinds of axes, four types of charts.
        macro_rules! on {
            ($x:expr, $y:expr) => {{
                let mut chart = ChartBuilder::on(area)
                    .caption(&self.title, ("sans-serif", 20))
                    .margin(12)
                    .x_label_area_size(46)
                    .y_label_area_size(70)
                    .right_y_label_area_size(10)
                    .build_cartesian_2d($x, $y)
                    .map_err(|e| e.to_string())?;
                chart
                    .configure_mesh()
                    .x_desc(&self.x.label)
                    .y_desc(&self.y.label)
                    .x_label_formatter(&|v| short(*v))
                    .y_label_formatter(&|v| short(*v))
                    .label_style(("sans-serif", 14))
                    .light_line_style(RGBColor(240, 240, 240))
                    .draw()
                    .map_err(|e| e.to_string())?;
                let mut colours = COLOURS.iter().cycle();
                for series in &self.series {
                    let places = series.points.iter().map(|(x, y, _)| (*x, *y));
                    if series.guide {
                        let style = RGBColor(150, 150, 150).stroke_width(1);
                        let drawn = chart.draw_series(LineSeries::new(places, style)).map_err(|e| e.to_string())?;
                        drawn.label(&series.name).legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
                        continue;
                    }
                    let colour = *colours.next().unwrap_or(&BLACK);
                    if series.joined {
                        chart
                            .draw_series(LineSeries::new(places.clone(), colour.mix(0.6).stroke_width(1)))
                            .map_err(|e| e.to_string())?;
                    }
                    let marks = places.map(|place| Circle::new(place, 4, colour.filled()));
                    let drawn = chart.draw_series(marks).map_err(|e| e.to_string())?;
                    drawn.label(&series.name).legend(move |(x, y)| Circle::new((x + 9, y), 4, colour.filled()));
                    let font = ("sans-serif", 12).into_font().color(&colour);
                    let texts = series.points.iter().filter(|p| !p.2.is_empty()).map(|(x, y, text)| {
                        EmptyElement::at((*x, *y)) + Text::new(text.clone(), (6, -12), font.clone())
                    });
                    chart.draw_series(texts).map_err(|e| e.to_string())?;
                }
                chart
                    .configure_series_labels()
                    .position(SeriesLabelPosition::UpperRight)
                    .background_style(WHITE.mix(0.85))
                    .border_style(RGBColor(200, 200, 200))
                    .label_font(("sans-serif", 13))
                    .draw()
                    .map_err(|e| e.to_string())
            }};
        }
        match (self.x.log, self.y.log) {
            (true, true) => on!(x.log_scale(), y.log_scale()),
            (true, false) => on!(x.log_scale(), y),
            (false, true) => on!(x, y.log_scale()),
            (false, false) => on!(x, y),
        }
    }
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

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, 1.0, 0.25, 1500.0, 1e7, 1e-5].map(short), ["0", "1", "0.25", "1500", "1e7", "1e-5"]);
    }
}
