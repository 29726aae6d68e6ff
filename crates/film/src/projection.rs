//! Projects the outlines of lights onto the film, and finds the parts of pixels that they cover.

use crate::section::ConvexPolygon;
use crate::view_camera::ViewCamera;
use glam::{DVec2, DVec3};
use radsight_picture::{View, ViewKind};
use radsight_render::{LightImage, RenderPlan, Viewpoint};
use std::ops::Range;

/// Parts into which connections of corners are divided where the projection curves them, and the
/// number of corners up to which all are connected.
const PARTS: usize = 8;
const FEW_CORNERS: usize = 8;

/// Nearest depth of an outline in a perspective view, relative to its farthest.
const MIN_DEPTH: f64 = 1e-3;

/// The images of lights that a picture may show; none if it shows more than `most` emitters.
pub(crate) fn images(plan: &RenderPlan, camera: &ViewCamera, most: usize) -> Vec<LightImage> {
    let view = camera.view();
    let from = match view.options().kind {
        ViewKind::Parallel => Viewpoint::Direction(view.direction()),
        _ => Viewpoint::Point(view.options().point),
    };
    let sides = sides(view);
    let may_show = |center, radius: f64| sides.iter().all(|side| side.height(center) >= -radius);
    LightImage::all(plan, from, may_show, most)
}

/// A plane at a side of a picture.
struct Side {
    /// Unit, towards the picture.
    normal: DVec3,
    point: DVec3,
}

impl Side {
    fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }
}

/// The planes between which everything lies that a perspective or parallel view shows; none for
/// other views.
fn sides(view: &View) -> Vec<Side> {
    if !matches!(view.options().kind, ViewKind::Perspective | ViewKind::Parallel) {
        return Vec::new();
    }
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|place| view.ray(place));
    let side = |index: usize| {
        let [from, to, opposite] = [0, 1, 2].map(|next| corners[(index + next) % 4]);
        let (from, to, opposite) = (from?, to?, opposite?);
        let along = to.origin + to.direction - from.origin;
        let normal = from.direction.cross(along).try_normalize()?;
        let inside = (opposite.origin + opposite.direction - from.origin).dot(normal);
        Some(Side { normal: normal * inside.signum(), point: from.origin })
    };
    (0..4).filter_map(side).collect()
}

/// The outline of an image on the film, in columns and rows from the upper left corner. `None`
/// where it has none.
pub(crate) fn projected(camera: &ViewCamera, image: &LightImage) -> Option<ConvexPolygon> {
    let corners =
        if image.is_distant { Corners::Directions(&image.outline) } else { Corners::Positions(&image.outline) };
    let outline = hull(camera, corners)?;
    if image.frame.is_empty() {
        return Some(outline);
    }
    Some(outline.clipped(&hull(camera, Corners::Positions(&image.frame))?))
}

/// A convex polygon in the hole of an image, as [`projected`]; `None` where it has none.
pub(crate) fn projected_hole(camera: &ViewCamera, image: &LightImage) -> Option<ConvexPolygon> {
    if image.hole.is_empty() { None } else { hull(camera, Corners::Positions(&image.hole)) }
}

/// How a visit of pixels goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Visit {
    GoOn,
    /// Without the pixels of the row that lie between this one and the next from the other end for
    /// which this is returned.
    SkipRow,
}

/// Visits the pixels of a part of a film, by columns and rows, that an outline may touch.
pub(crate) fn visit_touched(
    outline: &ConvexPolygon,
    (columns, rows): (Range<usize>, Range<usize>),
    mut visit: impl FnMut(usize, usize) -> Visit,
) {
    let range = |low: f64, high: f64, of: &Range<usize>| {
        (low.floor().max(of.start as f64) as usize)..(high.ceil().max(0.0).min(of.end as f64) as usize)
    };
    let [low, high] = outline.bounds();
    let rows = range(low.y, high.y, &rows);
    let is_single = rows.len() == 1;
    for row in rows {
        let [low, high] = if is_single { [low, high] } else { outline.between(row as f64, row as f64 + 1.0).bounds() };
        let columns = range(low.x, high.x, &columns);
        if let Some(first) = columns.clone().find(|column| visit(*column, row) == Visit::SkipRow) {
            let _ = (first + 1..columns.end).rev().find(|column| visit(*column, row) == Visit::SkipRow);
        }
    }
}

/// How much of a pixel an outline covers.
pub(crate) enum Cover {
    Nothing,
    /// In the pixel's unit square, upwards.
    Part(ConvexPolygon),
    All,
}

/// The square over which the rays of a pixel are distributed, in columns and rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelSquare {
    corner: DVec2,
    side: f64,
}

impl PixelSquare {
    pub(crate) fn new(column: usize, row: usize, side: f64) -> PixelSquare {
        PixelSquare { corner: DVec2::new(column as f64, row as f64) + 0.5 - 0.5 * side, side }
    }

    /// A place on the film in the unit square: from the top row down to upwards in the pixel.
    pub(crate) fn upright(&self, at: DVec2) -> DVec2 {
        let at = (at - self.corner) / self.side;
        DVec2::new(at.x, 1.0 - at.y)
    }

    /// Whether a polygon holds all of it.
    pub(crate) fn is_within(&self, polygon: &ConvexPolygon) -> bool {
        !polygon.corners().is_empty() && polygon.holds(&self.on_film())
    }

    fn on_film(&self) -> ConvexPolygon {
        ConvexPolygon::square().map(|at| self.corner + at * self.side)
    }

    /// The part of the unit square that an outline covers.
    pub(crate) fn cover(&self, outline: &ConvexPolygon) -> Cover {
        let square = self.on_film();
        if outline.holds(&square) {
            return Cover::All;
        }
        let part = outline.clipped(&square);
        if part.area() > 0.0 {
            Cover::Part(ConvexPolygon::hull(part.map(|at| self.upright(at)).corners().to_vec()))
        } else {
            Cover::Nothing
        }
    }
}

/// The corners of an outline in space.
#[derive(Clone, Copy, Debug)]
enum Corners<'a> {
    Positions(&'a [DVec3]),
    /// Unit directions from the eye.
    Directions(&'a [DVec3]),
}

/// The convex hull of projected points, in columns and rows from the upper left corner.
fn hull(camera: &ViewCamera, corners: Corners<'_>) -> Option<ConvexPolygon> {
    let view = camera.view();
    let options = view.options();
    // The distance of a direction does not matter, except for rounding.
    let (mut points, scale): (Vec<DVec3>, f64) = match corners {
        Corners::Positions(points) => (points.iter().map(|at| *at - options.point).collect(), 1.0),
        Corners::Directions(directions) => (directions.to_vec(), 1.0 + options.fore),
    };
    match options.kind {
        ViewKind::Perspective => points = before_the_eye(&points, view.direction()),
        ViewKind::Parallel => {}
        _ => points.extend(connections(&points)),
    }
    let size = DVec2::new(camera.columns() as f64, camera.rows() as f64);
    let place = |at: &DVec3| {
        // A hemispherical view would show what lies behind it before it.
        let location = view.locate(options.point + *at * scale).filter(|location| location.distance > 0.0)?;
        Some(DVec2::new(location.x, 1.0 - location.y) * size).filter(|place| place.is_finite())
    };
    Some(ConvexPolygon::hull(points.iter().map(place).collect::<Option<Vec<DVec2>>>()?))
}

/// The points before the eye, and where connections to the others cross a plane near it; places
/// from the eye.
fn before_the_eye(points: &[DVec3], direction: DVec3) -> Vec<DVec3> {
    let depth = |at: &DVec3| at.dot(direction);
    let nearest = MIN_DEPTH * points.iter().map(depth).fold(0.0, f64::max);
    let (before, behind): (Vec<DVec3>, Vec<DVec3>) = points.iter().partition(|at| depth(at) > nearest);
    let crossing = |before: &DVec3, behind: &DVec3| {
        let [far, near] = [before, behind].map(|at| depth(at) - nearest);
        before.lerp(*behind, far / (far - near))
    };
    let crossings = before.iter().flat_map(|before| behind.iter().map(move |behind| crossing(before, behind)));
    let crossings: Vec<DVec3> = crossings.collect();
    before.into_iter().chain(crossings).collect()
}

/// Points on the connections of a few points.
fn connections(points: &[DVec3]) -> Vec<DVec3> {
    if points.len() > FEW_CORNERS {
        return Vec::new();
    }
    let pairs = (0..points.len()).flat_map(|second| (0..second).map(move |first| (first, second)));
    let parts = |(first, second): (usize, usize)| {
        (1..PARTS).map(move |part| points[first].lerp(points[second], part as f64 / PARTS as f64))
    };
    pairs.flat_map(parts).collect()
}
