//! Meshes of many kinds, each a function of its numbers.

mod bodies;
mod place;
mod sheets;
mod soups;

use super::random::Random;
use place::Place;
use subpixel_shadows::scene::Mesh;

/// A kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Triangles that share no vertex.
    LooseSoup,
    /// Triangles of any three of a few vertices.
    WeldedSoup,
    /// Fans of triangles round common edges.
    Fans,
    /// Sheets 1 to 1000 ulps apart, welded or not.
    Sheets,
    /// Triangles with copies a few ulps away at some corners, the others shared.
    NearCopies,
    /// Bodies that stand twice, or one in the other.
    Doubled,
    /// Long thin triangles.
    Slivers,
    /// Triangles twice and more often, turned over or not.
    Duplicates,
    /// Overlaps in one plane.
    OnePlane,
    /// Vertices on the edges of others.
    TJunctions,
    /// Thin closed plates.
    Plates,
    /// Huge beside tiny.
    Scales,
    /// Far from the origin.
    Far,
    /// Triangles of no area among good ones.
    Degenerate,
    /// Boxes with common faces, edges and corners.
    Contacts,
    /// A few bodies, as in ordinary scenes.
    Bodies,
    /// Two kinds together.
    Mixed,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 17] = [
        Self::LooseSoup,
        Self::WeldedSoup,
        Self::Fans,
        Self::Sheets,
        Self::NearCopies,
        Self::Doubled,
        Self::Slivers,
        Self::Duplicates,
        Self::OnePlane,
        Self::TJunctions,
        Self::Plates,
        Self::Scales,
        Self::Far,
        Self::Degenerate,
        Self::Contacts,
        Self::Bodies,
        Self::Mixed,
    ];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::LooseSoup => "loose soup",
            Self::WeldedSoup => "welded soup",
            Self::Fans => "fans",
            Self::Sheets => "sheets",
            Self::NearCopies => "near copies",
            Self::Doubled => "doubled",
            Self::Slivers => "slivers",
            Self::Duplicates => "duplicates",
            Self::OnePlane => "one plane",
            Self::TJunctions => "T-junctions",
            Self::Plates => "thin plates",
            Self::Scales => "huge and tiny",
            Self::Far => "far away",
            Self::Degenerate => "degenerate",
            Self::Contacts => "contacts",
            Self::Bodies => "bodies",
            Self::Mixed => "mixed",
        }
    }

    /// A mesh of this kind.
    pub fn mesh(self, r: &mut Random) -> Mesh {
        match self {
            Self::LooseSoup => any_place(r, |r| soups::loose(r, 200)),
            Self::WeldedSoup => any_place(r, soups::welded),
            Self::Fans if r.chance(0.6) => soups::fans(r),
            Self::Fans => any_place(r, soups::fans),
            Self::Sheets => sheets::layered(r),
            Self::NearCopies => {
                let mesh = any_place(r, |r| if r.chance(0.5) { soups::loose(r, 60) } else { bodies::tame(r) });
                soups::near_copies(r, mesh)
            }
            Self::Doubled => bodies::doubled(r),
            Self::Slivers => any_place(r, soups::slivers),
            Self::Duplicates => {
                let mesh = any_place(r, base);
                soups::repeated(r, mesh)
            }
            Self::OnePlane => any_place(r, sheets::coplanar),
            Self::TJunctions => sheets::t_junctions(r),
            Self::Plates => sheets::plate(r),
            Self::Scales => bodies::scales(r),
            Self::Far => {
                let mesh = base(r);
                Place::far(r).put(&mesh)
            }
            Self::Degenerate => {
                let mesh = any_place(r, base);
                soups::degenerate(r, mesh)
            }
            Self::Contacts => any_place(r, sheets::contacts),
            Self::Bodies => any_place(r, bodies::tame),
            Self::Mixed => {
                let first = r.pick(Self::ALL);
                let second = r.pick(Self::ALL);
                let pure = |kind: Self| if kind == Self::Mixed { Self::Fans } else { kind };
                let mut mesh = pure(first).mesh(r);
                let other = pure(second).mesh(r);
                bodies::join(&mut mesh, &other);
                mesh
            }
        }
    }
}

/// One of the plain kinds.
fn base(r: &mut Random) -> Mesh {
    match r.whole(0, 4) {
        0 => soups::loose(r, 60),
        1 => soups::welded(r),
        2 => sheets::contacts(r),
        3 => sheets::coplanar(r),
        _ => bodies::tame(r),
    }
}

fn any_place(r: &mut Random, make: impl FnOnce(&mut Random) -> Mesh) -> Mesh {
    let mesh = make(r);
    Place::any(r).put(&mesh)
}
