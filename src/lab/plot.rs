//! Cost against error, both logarithmic, as an SVG picture: points in series, the Pareto front, and the point in use.
//!
//! Values that have no logarithm, which are zero, negative, NaN and infinite ones, are left out, counted, and the picture
//! says so. Colours are those of Okabe and Ito, "Color Universal Design" (2008), which the colour-blind tell apart; each
//! series also has a shape of its own. The ground is white, so that the picture reads the same on a dark page.

mod axis;
mod text;

use std::fmt::Write as _;

use axis::{Axis, log};
use text::{escaped, lines};

/// Points that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Pairs of x and y.
    pub points: Vec<[f64; 2]>,
    /// Whether a line joins them, in their order. It breaks where a point is left out.
    pub joined: bool,
}

/// What to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Heading.
    pub title: String,
    /// What runs to the right, with its unit, such as `march (ms)`.
    pub x_label: String,
    /// What runs up, with its unit.
    pub y_label: String,
    /// Points.
    pub series: Vec<Series>,
    /// The Pareto front, drawn as a line in this order.
    pub front: Vec<[f64; 2]>,
    /// The point in use, drawn as a ring.
    pub current: Option<[f64; 2]>,
}

/// A finished plot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    /// The text of an SVG file.
    pub svg: String,
    /// Points of the series that have no place on logarithmic axes.
    pub left_out: usize,
}

const WIDTH: f64 = 760.0;
const AREA_HEIGHT: f64 = 400.0;
/// Room for the numbers of the y axis, and to the right of the area for half a number of the x axis.
const NUMBERS: f64 = 66.0;
const RIGHT: f64 = 36.0;
const EDGE: f64 = 14.0;
const TITLE: f64 = 17.0;
const TEXT: f64 = 13.0;
/// From one line of text to the next, in sizes of the text.
const LEADING: f64 = 1.4;
/// From the start of an entry of the legend to its text, and from its text to the next entry.
const SWATCH: f64 = 28.0;
const GAP: f64 = 20.0;

const INK: &str = "#222222";
/// Without the yellow, which is hardly seen on white, and the black, which is the front's.
const COLOURS: [&str; 6] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
/// Circle, square, triangle, diamond, triangle downwards, plus, cross; as paths around the point. There is one more than
/// colours, so that 42 series all look different.
const SHAPES: [&str; 7] = [
    "M5 0A5 5 0 1 1 -5 0A5 5 0 1 1 5 0Z",
    "M-4.5 -4.5H4.5V4.5H-4.5Z",
    "M0 -6L5.5 4H-5.5Z",
    "M0 -6.5L6.5 0L0 6.5L-6.5 0Z",
    "M0 6L5.5 -4H-5.5Z",
    "M-1.6 -6H1.6V-1.6H6V1.6H1.6V6H-1.6V1.6H-6V-1.6H-1.6Z",
    "M-3.2 -5.4L0 -2.2L3.2 -5.4L5.4 -3.2L2.2 0L5.4 3.2L3.2 5.4L0 2.2L-3.2 5.4L-5.4 3.2L-2.2 0L-5.4 -3.2Z",
];

/// A logarithmic axis, for whoever draws it otherwise than as SVG.
#[derive(Clone, Debug, PartialEq)]
pub struct Ruler {
    /// Decimal logarithms of the ends.
    pub range: [f64; 2],
    /// Decimal logarithms of the ticks, with the numbers of those that have one.
    pub ticks: Vec<(f64, Option<String>)>,
}

impl Ruler {
    /// Where a value lies between the ends, 0 to 1; `None` for what has no logarithm.
    pub fn place(&self, value: f64) -> Option<f64> {
        Some((log(value)? - self.range[0]) / (self.range[1] - self.range[0]))
    }
}

impl Plot {
    /// The axes that hold all its points.
    pub fn rulers(&self) -> [Ruler; 2] {
        [0, 1].map(|side| {
            let axis = Axis::new(self.shown().map(|point| point[side]));
            let ticks = axis.ticks.iter().map(|tick| (tick.log(), tick.numbered.then(|| axis.plain_number(*tick))));
            Ruler { range: axis.range, ticks: ticks.collect() }
        })
    }

    /// Draws it.
    pub fn svg(&self) -> Drawing {
        let left_out =
            self.series.iter().flat_map(|series| &series.points).filter(|point| logs(**point).is_none()).count();
        let page = Page::new(self, left_out);
        let mut svg = String::new();
        self.draw(&page, &mut svg);
        Drawing { svg, left_out }
    }

    fn draw(&self, page: &Page, svg: &mut String) {
        let title = escaped(&self.title);
        let _ = write!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" \
             height=\"{height}\" role=\"img\" font-family=\"sans-serif\" font-size=\"{TEXT}\" fill=\"{INK}\">\n\
             <title>{title}</title>\n<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n",
            height = page.height,
        );
        page.draw_text(svg);
        page.draw_axes(svg);
        for (index, series) in self.series.iter().enumerate().filter(|(_, series)| series.joined) {
            page.draw_line(svg, &series.points, &format!("stroke=\"{}\" stroke-width=\"1.5\"", colour(index)));
        }
        page.draw_line(svg, &self.front, FRONT_STYLE);
        for (index, series) in self.series.iter().enumerate() {
            for place in series.points.iter().filter_map(|point| page.place(*point)) {
                draw_marker(svg, "point", index, place);
            }
        }
        if let Some(place) = self.current.and_then(|point| page.place(point)) {
            draw_ring(svg, place);
        }
        page.draw_legend(svg);
        svg.push_str("</svg>\n");
    }

    /// All points that have a place.
    fn shown(&self) -> impl Iterator<Item = [f64; 2]> {
        let series = self.series.iter().flat_map(|series| &series.points);
        series.chain(&self.front).chain(&self.current).filter_map(|point| logs(*point))
    }
}

const FRONT_STYLE: &str = "stroke=\"#000000\" stroke-width=\"1.5\"";

fn logs([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    Some([log(x)?, log(y)?])
}

fn colour(index: usize) -> &'static str {
    COLOURS[index % COLOURS.len()]
}

fn draw_marker(svg: &mut String, class: &str, index: usize, [x, y]: [f64; 2]) {
    let _ = writeln!(
        svg,
        "<path class=\"{class}\" transform=\"translate({x:.2} {y:.2})\" d=\"{}\" fill=\"{}\" stroke=\"#FFFFFF\" \
         stroke-width=\"0.8\"/>",
        SHAPES[index % SHAPES.len()],
        colour(index),
    );
}

fn draw_ring(svg: &mut String, [x, y]: [f64; 2]) {
    let _ = writeln!(
        svg,
        "<circle class=\"current\" cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"9\" fill=\"none\" stroke=\"#000000\" \
         stroke-width=\"2\"/>"
    );
}

/// What an entry of the legend shows.
#[derive(Clone, Copy, Debug)]
enum Key {
    Series { index: usize, joined: bool },
    Front,
    Current,
}

/// One entry of the legend.
#[derive(Clone, Debug)]
struct Entry {
    key: Key,
    text: String,
    place: [f64; 2],
}

/// A line of text: its middle, or its start for notes.
#[derive(Clone, Debug)]
struct Line {
    text: String,
    place: [f64; 2],
    attributes: String,
}

/// Where everything lies.
#[derive(Clone, Debug)]
struct Page {
    height: f64,
    /// Left, top, right and bottom of the plotting area.
    area: [f64; 4],
    axes: [Axis; 2],
    text: Vec<Line>,
    legend: Vec<Entry>,
}

impl Page {
    fn new(plot: &Plot, left_out: usize) -> Self {
        let step = TEXT * LEADING;
        // Bold letters are wider by an eighth at most.
        let title = lines(&plot.title, TITLE * 1.125, WIDTH - 2.0 * EDGE, 2);
        let y_label = lines(&plot.y_label, TEXT, AREA_HEIGHT, 2);
        let left = EDGE + y_label.len() as f64 * step + NUMBERS;
        let top = 2.0 * EDGE + title.len() as f64 * TITLE * LEADING;
        let area = [left, top, WIDTH - RIGHT, top + AREA_HEIGHT];
        let (middle, half_way) = (f64::midpoint(area[0], area[2]), f64::midpoint(area[1], area[3]));
        let x_label = lines(&plot.x_label, TEXT, area[2] - area[0], 2);

        let mut text = Vec::new();
        let mut line = |text_line: &str, place: [f64; 2], attributes: &str| {
            text.push(Line { text: text_line.to_owned(), place, attributes: attributes.to_owned() });
        };
        for (row, title) in title.iter().enumerate() {
            let place = [WIDTH / 2.0, EDGE + (row as f64 + 0.8) * TITLE * LEADING];
            line(title, place, &format!("text-anchor=\"middle\" font-weight=\"bold\" font-size=\"{TITLE}\""));
        }
        for (row, label) in y_label.iter().enumerate() {
            let [x, y] = [EDGE + (row as f64 + 0.8) * step, half_way];
            line(label, [x, y], &format!("text-anchor=\"middle\" transform=\"rotate(-90 {x:.2} {y:.2})\""));
        }
        let mut bottom = area[3] + 1.6 * step;
        for label in &x_label {
            bottom += step;
            line(label, [middle, bottom], "text-anchor=\"middle\"");
        }
        if left_out > 0 {
            bottom += step * 1.3;
            line(&note(left_out), [EDGE, bottom], "font-style=\"italic\"");
        }
        let (legend, bottom) = legend(plot, bottom + step * 0.5);
        let axes = [0, 1].map(|side| Axis::new(plot.shown().map(|point| point[side])));
        Self { height: (bottom + EDGE).ceil(), area, axes, text, legend }
    }

    /// Where a point lies, or `None` if it has no logarithm.
    fn place(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        logs(point).map(|[x, y]| [self.along_x(x), self.along_y(y)])
    }

    fn along_x(&self, log: f64) -> f64 {
        let [low, high] = self.axes[0].range;
        self.area[0] + (log - low) / (high - low) * (self.area[2] - self.area[0])
    }

    fn along_y(&self, log: f64) -> f64 {
        let [low, high] = self.axes[1].range;
        self.area[3] - (log - low) / (high - low) * (self.area[3] - self.area[1])
    }

    fn draw_text(&self, svg: &mut String) {
        for Line { text, place: [x, y], attributes } in &self.text {
            let _ = writeln!(svg, "<text x=\"{x:.2}\" y=\"{y:.2}\" {attributes}>{}</text>", escaped(text));
        }
    }

    fn draw_axes(&self, svg: &mut String) {
        let [left, top, right, bottom] = self.area;
        let mut line = |from: [f64; 2], to: [f64; 2], ink: &str| {
            let ([x1, y1], [x2, y2]) = (from, to);
            let _ = writeln!(svg, "<path d=\"M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}\" stroke=\"{ink}\"/>");
        };
        let grid = "#DDDDDD";
        for tick in self.axes[0].ticks.iter().filter(|tick| tick.numbered) {
            let x = self.along_x(tick.log());
            line([x, top], [x, bottom], grid);
        }
        for tick in self.axes[1].ticks.iter().filter(|tick| tick.numbered) {
            let y = self.along_y(tick.log());
            line([left, y], [right, y], grid);
        }
        for tick in &self.axes[0].ticks {
            let x = self.along_x(tick.log());
            line([x, bottom], [x, bottom - if tick.numbered { 8.0 } else { 4.0 }], INK);
        }
        for tick in &self.axes[1].ticks {
            let y = self.along_y(tick.log());
            line([left, y], [left + if tick.numbered { 8.0 } else { 4.0 }, y], INK);
        }
        let _ = writeln!(
            svg,
            "<rect class=\"area\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"none\" \
             stroke=\"{INK}\"/>",
            right - left,
            bottom - top,
        );
        for tick in self.axes[0].ticks.iter().filter(|tick| tick.numbered) {
            let (x, number) = (self.along_x(tick.log()), self.axes[0].number(*tick));
            let y = bottom + 1.5 * TEXT;
            let _ = writeln!(svg, "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"middle\">{number}</text>");
        }
        for tick in self.axes[1].ticks.iter().filter(|tick| tick.numbered) {
            let (y, number) = (self.along_y(tick.log()) + 0.35 * TEXT, self.axes[1].number(*tick));
            let _ = writeln!(svg, "<text x=\"{:.2}\" y=\"{y:.2}\" text-anchor=\"end\">{number}</text>", left - 7.0);
        }
    }

    /// A line through the points, with a gap where one has no place.
    fn draw_line(&self, svg: &mut String, points: &[[f64; 2]], style: &str) {
        let mut path = String::new();
        let mut joins = false;
        for point in points {
            let place = self.place(*point);
            if let Some([x, y]) = place {
                let _ = write!(path, "{}{x:.2} {y:.2}", if joins { 'L' } else { 'M' });
            }
            joins = place.is_some();
        }
        if !path.is_empty() {
            let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke-linejoin=\"round\" {style}/>");
        }
    }

    fn draw_legend(&self, svg: &mut String) {
        for Entry { key, text, place: [x, y] } in &self.legend {
            let middle = [x + SWATCH / 2.0 - 4.0, y - 0.35 * TEXT];
            let mut stroke = |style: &str| {
                let [from, to, at] = [*x, x + SWATCH - 8.0, middle[1]];
                let _ = writeln!(svg, "<path d=\"M{from:.2} {at:.2}H{to:.2}\" {style}/>");
            };
            match *key {
                Key::Series { index, joined } => {
                    if joined {
                        stroke(&format!("stroke=\"{}\" stroke-width=\"1.5\"", colour(index)));
                    }
                    draw_marker(svg, "key", index, middle);
                }
                Key::Front => stroke(FRONT_STYLE),
                Key::Current => draw_ring(svg, middle),
            }
            let _ = writeln!(svg, "<text x=\"{:.2}\" y=\"{y:.2}\">{}</text>", x + SWATCH, escaped(text));
        }
    }
}

fn note(left_out: usize) -> String {
    match left_out {
        1 => "1 point is not shown: it has a value that is not above zero, or not finite.".to_owned(),
        _ => format!("{left_out} points are not shown: they have a value that is not above zero, or not finite."),
    }
}

/// Entries of the legend in rows below `top`, and where the last row ends.
fn legend(plot: &Plot, top: f64) -> (Vec<Entry>, f64) {
    let series = plot.series.iter().enumerate().map(|(index, series)| {
        let name = if series.name.trim().is_empty() { "(without a name)" } else { &series.name };
        (Key::Series { index, joined: series.joined }, name)
    });
    let is_shown = |points: &[[f64; 2]]| points.iter().any(|point| logs(*point).is_some());
    let front = is_shown(&plot.front).then_some((Key::Front, "Pareto front"));
    let current = is_shown(plot.current.as_slice()).then_some((Key::Current, "current setting"));
    let step = 1.7 * TEXT;
    let (mut x, mut y) = (EDGE, top + step);
    let mut entries = Vec::new();
    for (key, name) in series.chain(front).chain(current) {
        let text = lines(name, TEXT, WIDTH - 2.0 * EDGE - SWATCH, 1).join(" ");
        let width = SWATCH + text::width(&text, TEXT);
        if x > EDGE && x + width > WIDTH - EDGE {
            (x, y) = (EDGE, y + step);
        }
        entries.push(Entry { key, text, place: [x, y] });
        x += width + GAP;
    }
    let bottom = if entries.is_empty() { top } else { y };
    (entries, bottom)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(name: &str, points: &[[f64; 2]]) -> Series {
        Series { name: name.to_owned(), points: points.to_vec(), joined: false }
    }

    fn example() -> Plot {
        Plot {
            title: "Error <of> the march & its cost".to_owned(),
            x_label: "texture reads per ray".to_owned(),
            y_label: "relRMSE against \"truth\"".to_owned(),
            series: vec![
                series("steps", &[[19.8, 0.333], [45.8, 0.132], [0.0, 0.1], [150.0, 0.038]]),
                Series { joined: true, ..series("octaves", &[[90.0, 0.108], [f64::NAN, 1.0], [200.0, 0.02]]) },
            ],
            front: vec![[19.8, 0.333], [45.8, 0.132], [150.0, 0.038], [200.0, 0.02]],
            current: Some([90.0, 0.108]),
        }
    }

    /// The value of an attribute in the text of an element.
    fn attribute<'a>(element: &'a str, name: &str) -> &'a str {
        let start = format!(" {name}=\"");
        let after = element.split_once(&start).unwrap_or_else(|| panic!("no {name} in {element}")).1;
        after.split('"').next().unwrap_or_default()
    }

    fn elements<'a>(svg: &'a str, class: &str) -> Vec<&'a str> {
        let mark = format!("class=\"{class}\"");
        svg.split('<').filter(|element| element.contains(&mark)).collect()
    }

    fn numbers(text: &str) -> Vec<f64> {
        let parts = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
        parts.filter(|part| !part.is_empty()).map(|part| part.parse().expect("a number")).collect()
    }

    /// Left, top, right, bottom of the plotting area.
    fn area(svg: &str) -> [f64; 4] {
        let element = elements(svg, "area")[0];
        let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| numbers(attribute(element, name))[0]);
        [x, y, x + w, y + h]
    }

    fn places(svg: &str, class: &str) -> Vec<[f64; 2]> {
        let place = |element: &&str| numbers(attribute(element, "transform"));
        elements(svg, class).iter().map(place).map(|numbers| [numbers[0], numbers[1]]).collect()
    }

    /// Panics where tags do not match, quotes do not close, or a bare & stands in the text.
    fn assert_well_formed(svg: &str) {
        let mut open: Vec<&str> = Vec::new();
        let entities = ["amp;", "lt;", "gt;", "quot;"];
        for part in svg.split('&').skip(1) {
            assert!(entities.iter().any(|entity| part.starts_with(entity)), "a bare & before {part:.20}");
        }
        for part in svg.split('<').skip(1) {
            let (tag, text) = part.split_once('>').expect("tags end");
            assert!(!text.contains('>'), "a bare > in {text}");
            assert!(tag.matches('"').count() % 2 == 0, "quotes pair up in {tag}");
            let name = tag.trim_matches('/').split_whitespace().next().expect("tags have names");
            if tag.starts_with('/') {
                assert_eq!(open.pop(), Some(name), "the tag that was opened last closes first");
            } else if !tag.ends_with('/') {
                open.push(name);
            }
        }
        assert!(open.is_empty(), "left open: {open:?}");
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"), "one root");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "all coordinates are numbers");
    }

    #[test]
    fn a_plot_is_well_formed_and_counts_what_it_leaves_out() {
        let drawing = example().svg();
        assert_well_formed(&drawing.svg);
        assert_eq!(drawing.left_out, 2, "a cost of 0 and a NaN");
        assert!(drawing.svg.contains("2 points are not shown"), "it says so");
        assert!(drawing.svg.contains("Error &lt;of&gt; the march &amp; its cost"), "{}", drawing.svg);
        assert_eq!((places(&drawing.svg, "point").len(), places(&drawing.svg, "key").len()), (5, 2));
        assert_eq!(elements(&drawing.svg, "current").len(), 2, "in the plot and in the legend");
    }

    #[test]
    fn every_finite_point_lies_inside() {
        let values = [5e-324, 1e-12, 0.01, 0.333, 1.0, 47.0, 1e6, f64::MAX];
        for low in values {
            for high in values {
                let points = [[low, high], [high, low], [low, low], [high, high]];
                let plot = Plot { series: vec![series("a", &points)], current: Some(points[0]), ..Plot::default() };
                let Drawing { svg, left_out } = plot.svg();
                assert_well_formed(&svg);
                let [left, top, right, bottom] = area(&svg);
                let places = places(&svg, "point");
                assert_eq!((places.len(), left_out), (4, 0));
                for [x, y] in places {
                    // The greatest shape reaches 7 pixels around its point, the ring 10.
                    let inside = x > left + 10.0 && x < right - 10.0 && y > top + 10.0 && y < bottom - 10.0;
                    assert!(inside, "({x}, {y}) for values {low} and {high}");
                }
            }
        }
    }

    #[test]
    fn equal_ratios_are_equal_distances_and_up_is_more() {
        let svg = Plot { series: vec![series("a", &[[1.0, 1.0], [10.0, 10.0], [100.0, 100.0]])], ..Plot::default() }
            .svg()
            .svg;
        let places = places(&svg, "point");
        let step = |side: usize, index: usize| places[index + 1][side] - places[index][side];
        assert!((step(0, 0) - step(0, 1)).abs() < 0.02 && step(0, 0) > 100.0, "{places:?}");
        assert!((step(1, 0) - step(1, 1)).abs() < 0.02 && step(1, 0) < -100.0, "{places:?}");
    }

    #[test]
    fn nothing_and_one_point_can_be_drawn() {
        let empty = Plot::default().svg();
        assert_well_formed(&empty.svg);
        assert_eq!(empty.left_out, 0);
        let one = Plot { series: vec![series("a", &[[3.0, 0.2]])], front: vec![[3.0, 0.2]], ..Plot::default() }.svg();
        assert_well_formed(&one.svg);
        assert_eq!(places(&one.svg, "point").len(), 1);
        let none =
            Plot { series: vec![series("a", &[[0.0, -1.0]])], current: Some([0.0, 1.0]), ..Plot::default() }.svg();
        assert_well_formed(&none.svg);
        assert_eq!((none.left_out, elements(&none.svg, "current").len()), (1, 0));
    }

    #[test]
    fn a_line_breaks_where_a_point_is_missing() {
        let svg = example().svg().svg;
        let octaves = svg.lines().find(|line| line.contains("stroke=\"#D55E00\"")).expect("a joined series");
        assert_eq!(attribute(octaves, "d").matches('M').count(), 2, "{octaves}");
        let front = svg.lines().find(|line| line.contains("stroke-linejoin") && line.contains("#000000"));
        assert_eq!(attribute(front.expect("a front"), "d").matches('L').count(), 3, "{front:?}");
    }

    #[test]
    fn series_differ_in_colour_or_shape() {
        let many = (0..42).map(|index| series(&format!("series {index}"), &[[1.0 + f64::from(index), 1.0]])).collect();
        let svg = Plot { series: many, ..Plot::default() }.svg().svg;
        let mut looks: Vec<[&str; 2]> = elements(&svg, "point")
            .iter()
            .map(|element| [attribute(element, "d"), attribute(element, "fill")])
            .collect();
        looks.sort_unstable();
        looks.dedup();
        assert_eq!(looks.len(), 42);
    }

    #[test]
    fn text_stays_on_the_page_and_apart() {
        let long = "a very long name that says far more than any legend has room for, and then goes on ".repeat(3);
        let mut plot = example();
        (plot.title, plot.x_label, plot.y_label) = (long.repeat(2), long.clone(), long.clone());
        plot.series.extend((0..9).map(|index| series(if index == 4 { &long } else { "step length" }, &[[50.0, 0.1]])));
        let left_out = 2;
        let page = Page::new(&plot, left_out);
        assert_well_formed(&plot.svg().svg);
        // Left, top, right and bottom of each upright text.
        let mut boxes: Vec<[f64; 4]> = Vec::new();
        for Entry { text, place: [x, y], .. } in &page.legend {
            boxes.push([*x, y - TEXT, x + SWATCH + text::width(text, TEXT), y + 0.3 * TEXT]);
        }
        for Line { text, place: [x, y], attributes } in
            page.text.iter().filter(|line| !line.attributes.contains("rotate"))
        {
            let size = if attributes.contains("bold") { TITLE * 1.125 } else { TEXT };
            let width = text::width(text, size);
            let left = if attributes.contains("middle") { x - width / 2.0 } else { *x };
            boxes.push([left, y - 0.8 * size, left + width, y + 0.25 * size]);
        }
        assert_eq!(boxes.len(), page.legend.len() + 2 + 2 + 1, "two lines of title and label, and a note");
        for (index, [left, top, right, bottom]) in boxes.iter().enumerate() {
            let on_page = *left >= 0.0 && *right <= WIDTH && *top >= 0.0 && *bottom <= page.height;
            assert!(on_page, "box {index}: {left} to {right}, {top} to {bottom} of {}", page.height);
            for other in &boxes[..index] {
                let apart = *left >= other[2] || other[0] >= *right || *top >= other[3] || other[1] >= *bottom;
                assert!(apart, "{:?} over {other:?}", boxes[index]);
            }
        }
    }
}
