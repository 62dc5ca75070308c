//! What joins the storeys of a plan: stairwells and shafts that lie above each other.

use d3dgen_model::Polygon;
use d3dgen_model::domain::Domain;
use d3dgen_model::storeys::LinkKind;

use crate::drawing::note;
use crate::layout::Layout;
use crate::shape::share_inside;

/// Share of the smaller of two rooms that lies above or below the other when they are one stairwell or shaft.
const ABOVE: f64 = 0.5;

/// Stairs or a lift: its rooms from the lowest storey to the highest, and the room type that they have in the domain.
pub(crate) struct Link {
    pub kind: LinkKind,
    pub room_type: String,
    pub rooms: Vec<usize>,
}

/// Returns what rooms of a type join storeys by, if they do, with the room type that such links have: the one of the same
/// use, for a staircase inside of a flat is stairs as well.
pub(crate) fn kind_of<'d>(room_type: &str, domain: &'d Domain) -> Option<(LinkKind, &'d str)> {
    let storeys = domain.circulation.storeys.as_ref()?;
    let elevator = storeys.elevator.as_ref().map(|e| (LinkKind::Elevator, e.room_type.as_str()));
    let known = [Some((LinkKind::Stairs, storeys.stairs.room_type.as_str())), elevator];
    let spaces = |id: &str| domain.room_type(id).map_or(&[][..], |r| r.spaces.as_slice());
    let own = spaces(room_type);
    known.into_iter().flatten().find(|(_, id)| *id == room_type || spaces(id).iter().any(|s| own.contains(s)))
}

/// Returns the stairs and lifts of a layout; stairs go from storey to storey, lifts may pass some by. Notes say which
/// stairwells and shafts join nothing.
pub(crate) fn links(layout: &mut Layout, types: &[String], domain: &Domain) -> Vec<Link> {
    let mut found: Vec<Link> = Vec::new();
    for kind in [LinkKind::Stairs, LinkKind::Elevator] {
        // rooms are listed from the lowest storey to the highest
        let all = types.iter().enumerate().filter_map(|(i, t)| kind_of(t, domain).map(|(k, id)| (i, k, id)));
        let mut left: Vec<(usize, &str)> = all.filter(|(_, k, _)| *k == kind).map(|(i, _, id)| (i, id)).collect();
        while !left.is_empty() {
            let (first, room_type) = left.remove(0);
            let mut rooms = vec![first];
            while let Some(at) = left.iter().position(|(r, _)| follows(layout, rooms[rooms.len() - 1], *r, kind)) {
                rooms.push(left.remove(at).0);
            }
            if rooms.len() > 1 {
                found.push(Link { kind, room_type: room_type.to_owned(), rooms });
                continue;
            }
            let message = format!(
                "`{}` on level {} has none of its kind above or below it; it joins no storeys",
                layout.rooms[first].label,
                layout.number_of(first)
            );
            layout.notes.push(note("not_linked", message));
        }
    }
    found
}

/// Returns true for a room that the stairs or the lift of another one lead up to next.
fn follows(layout: &Layout, below: usize, above: usize, kind: LinkKind) -> bool {
    let (a, b) = (&layout.rooms[below], &layout.rooms[above]);
    let rises = if kind == LinkKind::Stairs { b.storey == a.storey + 1 } else { b.storey > a.storey };
    rises && overlap(&a.polygon, &b.polygon) >= ABOVE
}

/// Returns the share of the smaller of two outlines that both have in common, 0 to 1.
fn overlap(a: &Polygon, b: &Polygon) -> f64 {
    let (small, large) = if a.area() <= b.area() { (a, b) } else { (b, a) };
    share_inside(small.corners(), large.corners())
}
