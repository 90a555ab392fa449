//! Line plots as SVG: panels side by side, with axes, units and legend.

use std::fmt::Write as _;

/// Line of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Label for the legend.
    pub label: String,
    /// Points; those that are not finite (or not positive on a logarithmic axis) are omitted.
    pub points: Vec<[f64; 2]>,
}

/// Diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Title above the diagram.
    pub title: String,
    /// Axis labels with units.
    pub axes: [String; 2],
    /// True for a logarithmic vertical axis.
    pub logarithmic: bool,
    /// Bar width, for a bar chart instead of lines.
    pub bars: Option<f64>,
    /// Lines or bars.
    pub series: Vec<Series>,
}

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 320.0;
/// Margins: left, right, top, bottom.
const MARGINS: [f64; 4] = [74.0, 16.0, 36.0, 50.0];
/// Colours that are distinguishable with colour blindness (Okabe and Ito 2008).
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#000000"];

/// Draws panels in rows of two.
pub fn svg(panels: &[Panel]) -> String {
    let columns = panels.len().min(2);
    let rows = panels.len().div_ceil(2);
    let (width, height) = (WIDTH * columns as f64, HEIGHT * rows as f64);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
         {height}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\">\n<rect width=\"100%\" \
         height=\"100%\" fill=\"white\"/>\n"
    );
    for (i, panel) in panels.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "<g transform=\"translate({},{})\">", WIDTH * (i % 2) as f64, HEIGHT * (i / 2) as f64);
        draw(panel, &mut out);
        out.push_str("</g>\n");
    }
    out.push_str("</svg>\n");
    out
}

/// Axis with range, ticks and scale type.
struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    logarithmic: bool,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, logarithmic: bool) -> Self {
        let usable = values.filter(|v| v.is_finite() && (!logarithmic || *v > 0.0));
        let value = |v: f64| if logarithmic { libm::log10(v) } else { v };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in usable.map(value) {
            low = low.min(v);
            high = high.max(v);
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        if logarithmic {
            (low, high) = (low.floor(), high.ceil().max(low.floor() + 1.0));
            let step = ((high - low) / 8.0).ceil();
            let ticks = (0..=((high - low) / step) as usize).map(|i| low + step * i as f64).collect();
            return Self { low, high, ticks, logarithmic };
        }
        low = low.min(0.0);
        if high <= low {
            high = low + 1.0;
        }
        let step = nice((high - low) / 5.0);
        high = (high / step).ceil() * step;
        low = (low / step).floor() * step;
        let ticks = (0..=((high - low) / step).round() as usize).map(|i| low + step * i as f64).collect();
        Self { low, high, ticks, logarithmic }
    }

    /// Relative position of a value on the axis, from 0 to 1.
    fn place(&self, value: f64) -> Option<f64> {
        let value = if self.logarithmic { libm::log10(value) } else { value };
        value.is_finite().then(|| (value - self.low) / (self.high - self.low))
    }

    fn label(&self, tick: f64) -> String {
        if self.logarithmic {
            return format!("10{}", superscript(&format!("{tick:.0}")));
        }
        let magnitude = self.high.abs().max(self.low.abs());
        match magnitude {
            m if !(1e-3..1e5).contains(&m) => format!("{tick:.1e}"),
            m if m >= 10.0 => format!("{tick:.0}"),
            m if m >= 1.0 => format!("{tick:.1}"),
            m if m >= 0.1 => format!("{tick:.2}"),
            _ => format!("{tick:.4}"),
        }
    }
}

/// Integer in superscript digits, as some viewers misplace a raised `tspan`.
fn superscript(number: &str) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    number.chars().map(|c| c.to_digit(10).map_or('⁻', |d| RAISED[d as usize])).collect()
}

/// Smallest 1, 2 or 5 times a power of ten that is at least `x`.
fn nice(x: f64) -> f64 {
    let power = libm::pow(10_f64, libm::log10(x).floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|f| f * power).find(|&s| s >= x * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn draw(panel: &Panel, out: &mut String) {
    let points = || panel.series.iter().flat_map(|s| s.points.iter());
    // Bars extend beyond their centres.
    let half = panel.bars.map_or(0.0, |width| 0.5 * width);
    let across = Axis::new(points().flat_map(|p| [p[0] - half, p[0] + half]), false);
    let up = Axis::new(points().map(|p| p[1]), panel.logarithmic);
    let [left, right, top, bottom] = MARGINS;
    let (w, h) = (WIDTH - left - right, HEIGHT - top - bottom);
    let x = |share: f64| left + w * share;
    let y = |share: f64| top + h * (1.0 - share);
    let _ = writeln!(
        out,
        "<text x=\"{left}\" y=\"20\" font-size=\"14\" font-weight=\"bold\">{}</text>",
        escaped(&panel.title)
    );
    for (tick, place) in up.ticks.iter().map(|&t| (t, y((t - up.low) / (up.high - up.low)))) {
        let _ = writeln!(
            out,
            "<line x1=\"{left}\" x2=\"{}\" y1=\"{place:.1}\" y2=\"{place:.1}\" stroke=\"#ddd\"/><text x=\"{}\" \
             y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left + w,
            left - 6.0,
            place + 4.0,
            up.label(tick)
        );
    }
    for (tick, place) in across.ticks.iter().map(|&t| (t, x((t - across.low) / (across.high - across.low)))) {
        let _ = writeln!(
            out,
            "<line x1=\"{place:.1}\" x2=\"{place:.1}\" y1=\"{}\" y2=\"{}\" stroke=\"#444\"/><text x=\"{place:.1}\" \
             y=\"{}\" text-anchor=\"middle\">{}</text>",
            top + h,
            top + h + 4.0,
            top + h + 17.0,
            across.label(tick)
        );
    }
    let _ =
        writeln!(out, "<rect x=\"{left}\" y=\"{top}\" width=\"{w}\" height=\"{h}\" fill=\"none\" stroke=\"#444\"/>");
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text><text transform=\"translate(16,{}) rotate(-90)\" \
         text-anchor=\"middle\">{}</text>",
        left + 0.5 * w,
        HEIGHT - 12.0,
        escaped(&panel.axes[0]),
        top + 0.5 * h,
        escaped(&panel.axes[1])
    );
    if let Some(width) = panel.bars {
        for p in panel.series.iter().flat_map(|series| &series.points) {
            let [from, to] = [-0.5, 0.5].map(|half| across.place(p[0] + half * width));
            if let (Some(from), Some(to), Some(top), Some(foot)) = (from, to, up.place(p[1]), up.place(0.0)) {
                let (width, height) = (w * (to - from), h * (top - foot));
                let _ = writeln!(
                    out,
                    "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{}\" stroke=\"white\" \
                     stroke-width=\"0.6\"/>",
                    x(from),
                    y(top),
                    COLOURS[0]
                );
            }
        }
        return;
    }
    for (series, colour) in panel.series.iter().zip(COLOURS.iter().cycle()) {
        let mut path = String::new();
        for p in &series.points {
            if let (Some(u), Some(v)) = (across.place(p[0]), up.place(p[1])) {
                let _ = write!(path, "{:.1},{:.1} ", x(u), y(v));
            }
        }
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\"/>",
            path.trim_end()
        );
    }
    legend(panel, left + w, top, out);
}

fn legend(panel: &Panel, right: f64, top: f64, out: &mut String) {
    let longest = panel.series.iter().map(|s| s.label.chars().count()).max().unwrap_or(0);
    let width = 34.0 + 6.4 * longest as f64;
    let x = right - width - 6.0;
    let _ = writeln!(
        out,
        "<rect x=\"{x}\" y=\"{}\" width=\"{width}\" height=\"{}\" fill=\"white\" fill-opacity=\"0.85\" stroke=\"#bbb\"/>",
        top + 6.0,
        8.0 + 16.0 * panel.series.len() as f64
    );
    for (i, (series, colour)) in panel.series.iter().zip(COLOURS.iter().cycle()).enumerate() {
        let y = top + 18.0 + 16.0 * i as f64;
        let _ = writeln!(
            out,
            "<line x1=\"{}\" x2=\"{}\" y1=\"{y}\" y2=\"{y}\" stroke=\"{colour}\" stroke-width=\"2.5\"/><text x=\"{}\" \
             y=\"{}\">{}</text>",
            x + 6.0,
            x + 24.0,
            x + 29.0,
            y + 4.0,
            escaped(&series.label)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(points: &[[f64; 2]], logarithmic: bool) -> Panel {
        Panel {
            title: "a < b".into(),
            axes: ["iteration".into(), "share (%)".into()],
            logarithmic,
            bars: None,
            series: vec![Series { label: "one".into(), points: points.to_vec() }],
        }
    }

    #[test]
    fn axes_have_round_ticks_and_hold_all_values() {
        let axis = Axis::new([3.0, 47.0].into_iter(), false);
        assert_eq!((axis.low, axis.high, axis.ticks.len()), (0.0, 50.0, 6));
        let log = Axis::new([0.02, 0.0, 700.0].into_iter(), true);
        assert_eq!((log.low, log.high), (-2.0, 3.0));
        assert_eq!((nice(0.11), nice(0.2), nice(6.0)), (0.2, 0.2, 10.0));
    }

    #[test]
    fn nothing_to_draw_and_odd_values_give_a_plot_without_nan() {
        for points in [&[][..], &[[0.0, 0.0]], &[[0.0, f64::NAN], [1.0, f64::INFINITY], [2.0, -1.0]]] {
            for logarithmic in [false, true] {
                let drawn = svg(&[panel(points, logarithmic)]);
                assert!(drawn.starts_with("<svg") && drawn.contains("a &lt; b") && drawn.contains("share (%)"));
                assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{drawn}");
            }
        }
    }
}
