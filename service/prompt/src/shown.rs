//! A fact in one line, as the examples of rules and `--explain` have it.

use d3dgen_model::brief::{AskedCount, Bound, Fact, RobotsAsk, RoomsAsk, Subject};
use serde::Serialize;

/// Returns a fact in one line, as the examples of rules and `--explain` have it.
pub(crate) fn shown(fact: &Fact) -> String {
    match fact {
        Fact::Rooms(asked) => shown_rooms(asked),
        Fact::Objects(o) => {
            let attributes: String = o.attributes.iter().map(|a| format!(" {a}")).collect();
            let room = shown_within(o.room.as_ref(), o.each_room);
            format!("objects {} {}{attributes}{room}", shown_count(&o.count), shown_subject(&o.object))
        }
        Fact::Capacity(c) => {
            let groups = c.groups.map_or(String::new(), |g| format!(" in {g} groups"));
            let room = shown_within(c.room.as_ref(), c.each_room);
            let room = c
                .of_rooms
                .map_or(room.clone(), |n| room.replace(" in ", &format!(" in {n} of ")).replace("of each ", "of "));
            let among = if c.among { "of " } else { "" };
            format!("capacity {} {among}{}{room}{groups}", shown_count(&c.count), named(&c.of))
        }
        Fact::Relation(r) => {
            format!("relation {} {} {}", shown_subject(&r.a), named(&r.relation), shown_subject(&r.b))
        }
        Fact::Storeys(s) => {
            format!("storeys {}{}", shown_count(&s.count), if s.basement { " and a basement" } else { "" })
        }
        Fact::Area(a) if a.bound == Bound::Exactly => format!("area {}", a.area_m2),
        Fact::Area(a) => format!("area {} {}", a.area_m2, named(&a.bound)),
        Fact::Robots(asked) => shown_robots(asked),
        Fact::People(p) => format!("people {} {}", shown_count(&p.count), p.role),
        Fact::Style(s) => format!("style {}", s.word),
        Fact::Accessible(a) => {
            format!("accessible{}", a.room.as_ref().map_or(String::new(), |r| format!(" {}", shown_subject(r))))
        }
        Fact::Forbidden(f) => {
            let what = f.room.iter().chain(&f.object).map(shown_subject).collect::<Vec<_>>().join(" ");
            format!("forbidden {what}{}", shown_within(f.within.as_ref(), false))
        }
        Fact::Only(o) => match (o.rooms, o.closed) {
            (Some(n), false) => format!("rooms in total {n}"),
            _ => "only these".to_owned(),
        },
        Fact::Site(s) => format!("site {}", named(&s.kind)),
        Fact::Other(o) => format!("other '{}'", o.wish),
    }
}

fn shown_rooms(r: &RoomsAsk) -> String {
    let among = if r.among { "of " } else { "" };
    let mut line = format!("rooms {} {among}{}", shown_count(&r.count), shown_subject(&r.room));
    r.area_m2.iter().for_each(|a| line += &format!(" {a} m2"));
    r.sides_m.iter().for_each(|s| line += &format!(" {} x {} m", s[0], s[1]));
    r.level.iter().for_each(|l| line += &format!(" level {l}"));
    r.attributes.iter().for_each(|a| line += &format!(" {a}"));
    r.each.iter().for_each(|e| line += &format!(" each {}", shown_subject(e)));
    line
}

fn shown_robots(r: &RobotsAsk) -> String {
    let mut line = format!("robots {} {}", shown_count(&r.count), r.kind);
    r.width_m.iter().for_each(|w| line += &format!(" {w} m wide"));
    r.length_m.iter().for_each(|w| line += &format!(" {w} m long"));
    for task in &r.tasks {
        line += &format!(" {}", task.verb);
        task.what.iter().for_each(|w| line += &format!(" '{w}'"));
        task.from.iter().for_each(|f| line += &format!(" from {}", shown_subject(f)));
        task.to.iter().for_each(|t| line += &format!(" to {}", shown_subject(t)));
    }
    r.keep_out.iter().for_each(|k| line += &format!(" not in {}", shown_subject(k)));
    line
}

fn shown_within(room: Option<&Subject>, each: bool) -> String {
    room.map_or(String::new(), |r| format!(" in {}{}", if each { "each " } else { "" }, shown_subject(r)))
}

fn shown_subject(subject: &Subject) -> String {
    subject.id.clone().unwrap_or_else(|| format!("'{}'", subject.name))
}

fn shown_count(count: &AskedCount) -> String {
    match count.bound {
        Bound::Exactly => count.n.to_string(),
        Bound::AtLeast => format!("{}+", count.n),
        Bound::AtMost => format!("{}-", count.n),
        Bound::About => format!("~{}", count.n),
    }
}

/// Returns the name that documents have for a value of an enum.
fn named<T: Serialize>(value: &T) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}
