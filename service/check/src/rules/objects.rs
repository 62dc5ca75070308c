//! Rules about single objects: within their room, apart from each other, held by something.

use d3dgen_model::domain::Mount;

use super::Findings;
use crate::context::{Context, Object, Room};
use crate::outline::Outline;

/// Tolerance of positions, m.
const SLACK_M: f64 = 0.02;
/// Footprint that may lie outside or be shared, m^2: 2 cm by 2 cm.
const SLACK_M2: f64 = 0.0004;
/// How far a wall-mounted object's back may be from the wall, m.
const FROM_WALL_M: f64 = 0.06;
/// Share of a footprint that must lie on what it stands on.
const ON_SUPPORT: f64 = 0.85;

pub fn size(c: &Context, out: &mut Findings) {
    for object in &c.objects {
        out.look();
        if object.placement.size_m.iter().any(|v| *v <= 0.0) {
            out.add(&object.placement.placement_id, "an extent is not positive");
        }
        if object.kind.is_none() {
            out.add(
                &object.placement.placement_id,
                format!("`{}` is no object of the domain", object.placement.object),
            );
        }
    }
}

pub fn outside(c: &Context, out: &mut Findings) {
    for object in &c.objects {
        out.look();
        let id = &object.placement.placement_id;
        let Some(room) = c.room(&object.placement.room_id) else {
            out.add(id, format!("its room `{}` is not in the plan", object.placement.room_id));
            continue;
        };
        let outside = outside_of(&object.outline, room);
        if outside > SLACK_M2 && !inset_fits(object, room) {
            out.add_figure(id, format!("{outside:.3} m2 stand outside the room"), outside, SLACK_M2, "m^2");
        }
    }
}

/// Returns the area of an outline that lies outside the net floor of a room, m2.
fn outside_of(outline: &Outline, room: &Room) -> f64 {
    outline.area() - room.net.iter().map(|r| outline.area_in(r)).sum::<f64>()
}

/// Returns true when the object fits after giving way by the tolerance on each side.
fn inset_fits(object: &Object, room: &Room) -> bool {
    outside_of(&object.outline.shrunk(SLACK_M), room) <= SLACK_M2
}

pub fn collision(c: &Context, out: &mut Findings) {
    let solid: Vec<&Object> = c.objects.iter().filter(|o| o.solid).collect();
    // in order of their west edges, so that only near pairs are compared
    let mut order: Vec<usize> = (0..solid.len()).collect();
    order.sort_by(|a, b| solid[*a].rect.x0.total_cmp(&solid[*b].rect.x0).then(a.cmp(b)));
    for (k, i) in order.iter().enumerate() {
        let a = solid[*i];
        out.look();
        for j in order[k + 1..].iter().take_while(|j| solid[**j].rect.x0 < a.rect.x1) {
            let b = solid[*j];
            let height = a.placement.top_m().min(b.placement.top_m()) - a.placement.pose.z.max(b.placement.pose.z);
            let area = if height > SLACK_M { a.outline.common_area(&b.outline) } else { 0.0 };
            if area > SLACK_M2 {
                let subject = format!("{}|{}", a.placement.placement_id, b.placement.placement_id);
                let message = format!("they share {area:.3} m2 over {height:.2} m of height");
                out.add_figure(subject, message, area, SLACK_M2, "m^2");
            }
        }
    }
}

pub fn support(c: &Context, out: &mut Findings) {
    for object in &c.objects {
        out.look();
        let p = object.placement;
        let found = match p.mount {
            Mount::Floor => (p.pose.z.abs() > SLACK_M).then(|| format!("stands {:.2} m above the floor", p.pose.z)),
            Mount::Wall => c.room(&p.room_id).and_then(|r| off_wall(object, r)),
            Mount::Ceiling => c.room(&p.room_id).and_then(|r| off_ceiling(object, r)),
            Mount::Surface => off_surface(c, object),
        };
        if let Some(message) = found {
            out.add(&p.placement_id, message);
        }
    }
}

fn off_wall(object: &Object, room: &Room) -> Option<String> {
    let touches = room.plan.net_polygon.edges().any(|e| object.outline.distance_to(&e) <= FROM_WALL_M);
    (!touches).then(|| "hangs on a wall and no wall is there".to_owned())
}

fn off_ceiling(object: &Object, room: &Room) -> Option<String> {
    let p = object.placement;
    // what hangs on a long rod still hangs from the ceiling; what starts below head height does not
    (p.top_m() < room.plan.ceiling_height_m * 0.5)
        .then(|| format!("hangs from the ceiling, and ends at {:.2} m", p.top_m()))
}

fn off_surface(c: &Context, object: &Object) -> Option<String> {
    let p = object.placement;
    let Some(id) = p.support.as_deref() else {
        return Some("stands on a surface and names none".to_owned());
    };
    let Some(base) = c.objects.iter().find(|o| o.placement.placement_id == id) else {
        return Some(format!("stands on `{id}`, which is not there"));
    };
    let top = base.placement.top_m();
    if base.placement.room_id != p.room_id {
        return Some(format!("stands on `{id}` in another room"));
    }
    if base.kind.is_some_and(|k| !c.domain.holds_things(k)) {
        return Some(format!("stands on `{id}`, which has no surface"));
    }
    if (p.pose.z - top).abs() > SLACK_M {
        return Some(format!("stands at {:.2} m on a top at {top:.2} m", p.pose.z));
    }
    let share = object.outline.common_area(&base.outline) / object.outline.area().max(1e-9);
    (share < ON_SUPPORT).then(|| format!("{:.0} % of it stand on `{id}`", share * 100.0))
}

pub fn ceiling(c: &Context, out: &mut Findings) {
    for object in &c.objects {
        let Some(room) = c.room(&object.placement.room_id) else { continue };
        out.look();
        let (top, height) = (object.placement.top_m(), room.plan.ceiling_height_m);
        if top > height + SLACK_M {
            let message = format!("reaches {top:.2} m under a ceiling at {height:.2} m");
            out.add_figure(&object.placement.placement_id, message, top, height, "m");
        }
    }
}
