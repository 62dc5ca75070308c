//! Doors to outdoors: the entrance, gates for vehicles, ways out at the ends of corridors and of full rooms.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Daylight, Zone};
use d3dgen_model::floorplan::{Door, DoorKind, Swing};
use d3dgen_model::measures::JAMB_M;
use d3dgen_model::{Point, Rect, Segment};

use super::super::cost::ill_placed;
use super::super::hall::passed_bedrooms;
use super::super::lattice::{Cellbox, OUTER_HALF_M, meters};
use super::super::outline::Stretch;
use super::super::realize::ONE_WAY_M;
use super::super::spec::{Brief, RoomSpec};
use super::spot::{Spot, View};
use super::{APPROACH_M, Laid, ONE_EXIT_PEOPLE, Site};
use crate::measures::{DOUBLE_FROM_M, GARDEN_DOOR_M, LEAST_WALL_M, MARGIN_M};

/// What a meter between the entrance and the nearest room for visitors counts against the length of its wall.
const TO_PUBLIC: f64 = 0.2;
/// What it counts there that rooms of the day are far from the entrance and bedrooms near.
const TO_ZONES: f64 = 7.0;
/// What it costs there that one passes a bedroom on the way to the living room.
const TO_LIVING: f64 = 7.0;
/// Wall between an entrance that stands aside and the corner of its room, on center lines, m.
const ENTRANCE_ASIDE_M: f64 = 0.4;
/// How much longer than the corridor is wide the wall at its end may be.
const END_WALL: f64 = 1.8;
/// Farthest that the ways out of a room are told apart by, m.
const MOST_WAY_M: f64 = 100.0;
/// What it costs that a home's entrance opens outwards.
const OUTWARD: f64 = 4.0;
/// How far an entrance stands aside at least where that is of use, m, and what it costs.
const ENTRANCE_SHIFT_M: f64 = 0.15;
const ENTRANCE_SHIFTED: f64 = 0.6;
/// What it costs that the leaf of an entrance stands open away from the nearer wall, and floor behind it on which one comes out
/// of another door, m.
const HINGE_AWAY: f64 = 0.15;
const BEHIND_LEAF_M: f64 = 0.8;
/// What it costs a door to the garden to be a meter nearer to the entrance, and to leave a meter less wall for windows than the
/// room needs; how far it is from the entrance at least, m.
const TO_STREET: f64 = 0.15;
const LOST_LIGHT: f64 = 2.0;
const FROM_STREET_M: f64 = 2.0;
/// What it costs that it is in the front where one comes in, and how far behind it another one lies, m; what each room costs
/// that one rather has it in.
const AT_STREET: f64 = 3.0;
const BACK_M: f64 = 3.0;
const LESS_LIVED_IN: f64 = 0.8;
/// Wall for windows that a square meter of floor needs, m: a seventh of it as glass 1.3 m high.
const GLASS_M_PER_M2: f64 = 0.11;

/// What it costs a gate to be at another side than those of its kind.
const OFF_YARD: f64 = 100.0;

/// A side of the building: whether its walls run north-south, and whether outdoors is at their lower end.
type Side = (bool, bool);

/// Returns true for two openings of one wall of which one begins before the other ends.
fn meets(a: &Segment, b: &Segment) -> bool {
    let span = |from: f64, to: f64| [from.min(to), from.max(to)];
    let crosses = |a: [f64; 2], b: [f64; 2]| a[0] < b[1] + JAMB_M && b[0] < a[1] + JAMB_M;
    crosses(span(a.start.x, a.end.x), span(b.start.x, b.end.x))
        && crosses(span(a.start.y, a.end.y), span(b.start.y, b.end.y))
}

impl Site<'_> {
    /// Places doors to outdoors.
    pub(super) fn lay_entrances(&self, entrances: &[(usize, bool)], laid: &mut Laid) {
        for &(room, main) in entrances {
            let shut = self.brief.party.filter(|party| !party.entered);
            let open = |s: &&Stretch| !shut.is_some_and(|party| party.covers(s));
            let stretches = self.stretches.iter().filter(|s| s.leads_out_of() == Some(room)).filter(open);
            let spots: Vec<Spot> = match self.standing_spot(&[room], main) {
                Some(spot) => vec![spot],
                None => stretches.flat_map(|s| self.entrance_spots(s, room, main, &laid.spots)).collect(),
            };
            if !laid.take_best(spots) && main {
                laid.missing.push(format!("outdoors to {}", self.brief.rooms[room].id));
            }
        }
    }

    /// Places the gates through which vehicles come in, at the end of the room rather than along it; those of one kind at one side
    /// of the building, as far as its walls allow.
    pub(super) fn lay_gates(&self, laid: &mut Laid) {
        let docks = self.brief.docks();
        let yards: Vec<Option<Side>> = docks.iter().map(|rooms| self.yard(rooms)).collect();
        for (room, spec) in self.brief.rooms.iter().enumerate().filter(|(_, spec)| spec.gate.is_some()) {
            let yard = docks.iter().position(|rooms| rooms.contains(&room)).and_then(|at| yards[at]);
            let mut spots: Vec<Spot> = self.standing_spot(&[room], false).into_iter().collect();
            if spots.is_empty() {
                let off = |side: Side| if yard.is_none_or(|yard| yard == side) { 0.0 } else { OFF_YARD };
                let all = self.gates_of(room).into_iter();
                spots.extend(all.map(|(side, spot)| Spot { penalty: spot.penalty + off(side), ..spot }));
            }
            if !laid.take_best(spots) {
                laid.missing.push(format!("outdoors to {}", spec.id));
            }
        }
    }

    /// Returns the side of the building at which most of these rooms may have their gates.
    fn yard(&self, rooms: &[usize]) -> Option<Side> {
        let mut held: BTreeMap<Side, usize> = BTreeMap::new();
        for &room in rooms {
            let sides: BTreeSet<Side> = self.gates_of(room).into_iter().map(|(side, _)| side).collect();
            sides.into_iter().for_each(|side| *held.entry(side).or_default() += 1);
        }
        held.into_iter().max_by_key(|(_, rooms)| *rooms).map(|(side, _)| side)
    }

    /// Returns where a room may have its gate, and at which side of the building that is.
    fn gates_of(&self, room: usize) -> Vec<(Side, Spot)> {
        let spec = &self.brief.rooms[room];
        let Some(clear) = spec.gate else { return Vec::new() };
        let walls = self.stretches.iter().filter(|s| s.leads_out_of() == Some(room) && !self.is_party(s));
        let of = |s: &Stretch| {
            let side = (s.vertical, s.low.is_none());
            self.gate_spots(s, (room, spec), clear, Brief::opening(clear)).into_iter().map(move |spot| (side, spot))
        };
        walls.flat_map(of).collect()
    }

    fn gate_spots(&self, s: &Stretch, (room, spec): (usize, &RoomSpec), clear: f64, opening: f64) -> Vec<Spot> {
        let (from, to) = self.usable(s);
        if to - from < opening - 1e-9 {
            return Vec::new();
        }
        let middle = (from + to - opening) / 2.0;
        let starts = [(middle, 0.0), (from, 0.5), (to - opening, 0.5)];
        if spec.is_gate_by_hand() {
            // a door for goods and staff leaves the room its windows
            let places = starts.into_iter().filter(|(start, _)| spec.daylight == Daylight::None || *start != middle);
            return places.filter_map(|(start, penalty)| self.outward_spot(s, room, (start, clear), penalty)).collect();
        }
        let spots = starts.into_iter().map(|(start, penalty)| {
            let line = Segment { start: s.point(start), end: s.point(start + opening) };
            let zone = self.zone(s, room, start, opening, APPROACH_M);
            let usual = self.door(line, DoorKind::Sliding, clear, s, &[room], None);
            let height_m = spec.gate_height.max(usual.height_m);
            let door = Door { automatic: true, height_m, ..usual };
            Spot { door, wall: None, view: View::Other, zones: vec![(room, zone)], penalty: penalty + meters(s.len()) }
        });
        spots.filter(|spot| spot.zones.iter().all(|(r, zone)| self.inside(*r, zone))).collect()
    }

    /// Places the door from where one lives to the garden, away from the street, where it leaves the room its windows.
    pub(super) fn lay_garden_door(&self, laid: &mut Laid) {
        let entrance = laid.spots.iter().find(|l| l.door.entrance).map(|l| l.door.line);
        let mut spots: Vec<Spot> = Vec::new();
        for (rank, &room) in self.brief.garden.iter().enumerate() {
            let way_out = |d: &Door| d.room_ids == [self.brief.rooms[room].id.clone()] && !d.entrance;
            if laid.spots.iter().any(|l| way_out(&l.door)) {
                return;
            }
            // a plan that is changed keeps what it had
            if let Some(spot) = self.standing_spot(&[room], false) {
                spots = vec![spot];
                break;
            }
            if !self.standing.is_empty() && !self.standing.iter().any(way_out) {
                continue;
            }
            let walls = self.stretches.iter().filter(|s| s.leads_out_of() == Some(room) && !self.is_party(s));
            let own = walls.flat_map(|s| self.garden_spots(s, room, entrance));
            spots.extend(own.map(|spot| Spot { penalty: spot.penalty + LESS_LIVED_IN * rank as f64, ..spot }));
        }
        // furniture finds its place beside the other doors as well
        spots.retain(|spot| laid.spots.iter().all(|other| spot.disturbs(other) == 0.0));
        laid.take_best(spots);
    }

    fn garden_spots(&self, s: &Stretch, room: usize, entrance: Option<Segment>) -> Vec<Spot> {
        let opening = Brief::opening(GARDEN_DOOR_M);
        let (from, to) = self.usable(s);
        if to - from < opening - 1e-9 {
            return Vec::new();
        }
        let lit = |wall: f64| if wall >= LEAST_WALL_M { wall - 2.0 * MARGIN_M } else { 0.0 };
        let others = self.stretches.iter().filter(|t| t.only_room() == Some(room) && *t != s && !self.is_party(t));
        let others: f64 = others.map(|t| lit(meters(t.len()))).sum();
        let starts = [from, (from + to - opening) / 2.0, to - opening].into_iter();
        let spots = starts.filter_map(|start| {
            let sides = [start - meters(s.from), meters(s.to) - start - opening];
            let light = others + sides.map(lit).iter().sum::<f64>();
            let at = s.point(start + opening / 2.0);
            let away = entrance.map_or(MOST_WAY_M, |e| e.middle().distance(at));
            let beside =
                entrance.is_some_and(|e| e.is_vertical() == s.vertical && (e.span().0 - meters(s.at)).abs() < BACK_M);
            let short = (GLASS_M_PER_M2 * self.net_m2[room] - light).max(0.0);
            let street = if beside { AT_STREET } else { 0.0 };
            let penalty = LOST_LIGHT * short + street - TO_STREET * away.min(MOST_WAY_M);
            let fits = light > 0.0 && away >= FROM_STREET_M;
            fits.then(|| self.outward_spot(s, room, (start, GARDEN_DOOR_M), penalty)).flatten()
        });
        spots.collect()
    }

    /// Returns true for an outer wall with neighbors behind it.
    pub(super) fn is_party(&self, s: &Stretch) -> bool {
        self.brief.party.is_some_and(|party| party.covers(s))
    }

    /// Places exits at the ends of corridors that are far from all others: nobody should have to run back through a wing.
    pub(super) fn lay_exits(&self, laid: &mut Laid) {
        let Some(spine) = self.brief.spine.filter(|_| self.brief.second_exit && !self.brief.upper && !self.brief.hub)
        else {
            return;
        };
        let way = |s: &Stretch| s.leads_out_of().filter(|room| *room == spine || Some(*room) == self.brief.locked);
        let is_end = |s: &&Stretch| way(s).is_some() && meters(s.len()) <= END_WALL * self.brief.spine_width;
        let middle = |s: &Stretch| s.point((meters(s.from) + meters(s.to)) / 2.0);
        let mut ends: Vec<Stretch> = self.stretches.iter().filter(is_end).copied().collect();
        ends.extend(self.corners_of_ring(spine));
        for _ in 0..ends.len() {
            let exits: Vec<(Point, f64)> =
                laid.spots.iter().filter_map(|l| self.way_out(spine, &l.door, laid)).collect();
            let far = self.walks(spine, &exits, &ends.iter().map(middle).collect::<Vec<_>>());
            let Some(at) = (0..ends.len()).max_by(|&a, &b| far[a].total_cmp(&far[b])) else { return };
            if far[at] < ONE_WAY_M {
                return;
            }
            let end = ends.remove(at);
            let spots = self.entrance_spots(&end, way(&end).unwrap_or(spine), false, &laid.spots);
            laid.take_best(spots);
        }
    }

    /// Returns where the corridors of a ring end at a facade along which another of them runs: the wall goes on, and what is an end
    /// to who walks there is no piece of wall by itself.
    fn corners_of_ring(&self, spine: usize) -> Vec<Stretch> {
        let long =
            |s: &&Stretch| s.leads_out_of() == Some(spine) && meters(s.len()) > END_WALL * self.brief.spine_width;
        let mut corners = Vec::new();
        for (_, b) in self.boxes.iter().filter(|(room, _)| self.brief.ring.is_some() && *room == spine) {
            let upright = b.width() >= b.height();
            let (ends, from, to) = if upright { ([b.x0, b.x1], b.y0, b.y1) } else { ([b.y0, b.y1], b.x0, b.x1) };
            let at_end = |s: &&Stretch| s.vertical == upright && ends.contains(&s.at) && s.from <= from && to <= s.to;
            corners.extend(self.stretches.iter().filter(long).filter(at_end).map(|s| Stretch { from, to, ..*s }));
        }
        corners
    }

    /// Places a way out of its own for each room of more people than may share one, and for the fullest room of a building of
    /// so many that has one door to outdoors: as far from the other doors of the room as its walls allow.
    pub(super) fn lay_room_exits(&self, laid: &mut Laid) {
        let brief = self.brief;
        if !brief.second_exit || brief.upper || brief.hub {
            return;
        }
        let outside = |l: &Laid| l.spots.iter().filter(|s| s.door.room_ids.len() == 1).count();
        let all: u32 = brief.rooms.iter().map(|r| r.people).fold(0, u32::saturating_add);
        let fullest =
            (0..brief.rooms.len()).filter(|&r| brief.rooms[r].people > 0).max_by_key(|&r| brief.rooms[r].people);
        for room in 0..brief.rooms.len() {
            let alone = all > ONE_EXIT_PEOPLE && outside(laid) < 2 && fullest == Some(room);
            if Some(room) == brief.spine || brief.rooms[room].people <= ONE_EXIT_PEOPLE && !alone {
                continue;
            }
            let id = &brief.rooms[room].id;
            let own: Vec<Point> =
                laid.spots.iter().filter(|l| l.door.room_ids.contains(id)).map(|l| l.door.line.middle()).collect();
            // who comes in there has one way out by it, and so many people need two
            if !alone && laid.spots.iter().any(|l| l.door.room_ids == [id.clone()]) {
                continue;
            }
            let away = |spot: &Spot| {
                own.iter().map(|p| p.distance(spot.door.line.middle())).fold(f64::MAX, f64::min).min(MOST_WAY_M)
            };
            let walls = self.stretches.iter().filter(|s| s.leads_out_of() == Some(room));
            let mut spots: Vec<Spot> = walls.flat_map(|s| self.entrance_spots(s, room, false, &laid.spots)).collect();
            spots.iter_mut().for_each(|spot| spot.penalty = MOST_WAY_M - away(spot));
            laid.take_best(spots);
        }
    }

    /// Returns where one leaves the corridor towards a door to outdoors, and how far that is from there, m.
    fn way_out(&self, spine: usize, exit: &Door, laid: &Laid) -> Option<(Point, f64)> {
        let [room] = &exit.room_ids[..] else { return None };
        let (id, at) = (&self.brief.rooms[spine].id, exit.line.middle());
        if room == id {
            return Some((at, 0.0));
        }
        let through = laid.spots.iter().find(|l| [room, id].iter().all(|id| l.door.room_ids.contains(id)))?;
        let door = through.door.line.middle();
        Some((door, door.distance(at)))
    }

    /// Returns how far points of a room are on foot from the nearest of some ways out, m: from part to part of it through the
    /// middle of what they share. Each way out has a length of its own beyond the room.
    fn walks(&self, room: usize, exits: &[(Point, f64)], points: &[Point]) -> Vec<f64> {
        let parts: Vec<Rect> = self.boxes.iter().filter(|b| b.0 == room).map(|b| b.1.to_rect()).collect();
        let holds = |part: &Rect, p: Point| part.grown(OUTER_HALF_M).contains(&Rect::new(p.x, p.y, p.x, p.y));
        let mut gates: Vec<Point> = Vec::new();
        for (n, a) in parts.iter().enumerate() {
            let meet = parts[n + 1..].iter().filter(|b| a.grown(0.01).overlaps(b));
            gates.extend(
                meet.map(|b| Rect::new(a.x0.max(b.x0), a.y0.max(b.y0), a.x1.min(b.x1), a.y1.min(b.y1)).center()),
            );
        }
        let of_part: Vec<Vec<usize>> =
            parts.iter().map(|part| (0..gates.len()).filter(|&g| holds(part, gates[g])).collect()).collect();
        let mut ways = vec![f64::MAX; gates.len()];
        let from_exits = |part: &Rect, p: Point| {
            let near = exits.iter().filter(|e| holds(part, e.0)).map(|(at, beyond)| at.distance(p) + beyond);
            near.fold(f64::MAX, f64::min)
        };
        for (part, own) in parts.iter().zip(&of_part) {
            own.iter().for_each(|&g| ways[g] = ways[g].min(from_exits(part, gates[g])));
        }
        let mut changed = true;
        while changed {
            changed = false;
            for (&a, &b) in of_part.iter().flat_map(|own| own.iter().flat_map(move |a| own.iter().map(move |b| (a, b))))
            {
                let way = ways[a] + gates[a].distance(gates[b]);
                if way < ways[b] - 1e-9 {
                    (ways[b], changed) = (way, true);
                }
            }
        }
        let to = |p: Point| {
            let here = parts.iter().zip(&of_part).filter(|(part, _)| holds(part, p));
            let walked = here.map(|(part, own)| {
                let through = own.iter().map(|&g| ways[g] + gates[g].distance(p));
                through.fold(from_exits(part, p), f64::min)
            });
            let straight = exits.iter().map(|(at, beyond)| at.distance(p) + beyond).fold(f64::MAX, f64::min);
            Some(walked.fold(f64::MAX, f64::min)).filter(|way| *way < f64::MAX).unwrap_or(straight)
        };
        points.iter().map(|&p| to(p)).collect()
    }

    /// Returns rooms that need a door to outdoors; the main one first.
    pub(super) fn entrances(&self) -> Vec<(usize, bool)> {
        let brief = self.brief;
        if brief.upper {
            return Vec::new();
        }
        let main = brief.rooms.iter().position(|r| r.entrance).or(brief.spine);
        let mut list: Vec<(usize, bool)> = main.map(|m| (m, true)).into_iter().collect();
        if let Some(spine) = brief.spine
            && brief.second_exit
        {
            list.push((spine, false));
        }
        list
    }

    fn entrance_spots(&self, s: &Stretch, room: usize, main: bool, laid: &[Spot]) -> Vec<Spot> {
        let clear = self.brief.entrance_width;
        let opening = Brief::opening(clear);
        let (from, to) = self.usable(s);
        if to - from < opening - 1e-9 {
            return Vec::new();
        }
        let spine = Some(room) == self.brief.spine;
        let middle = (from + to - opening) / 2.0;
        // a little aside in a room where that leaves the wall for a window
        let aside = meters(s.from) + ENTRANCE_ASIDE_M;
        let window = |start: f64| {
            let sides = [start - meters(s.from), meters(s.to) - start - opening];
            sides.into_iter().any(|wall| wall >= LEAST_WALL_M)
        };
        let lit = spine || self.brief.rooms[room].daylight == Daylight::None || window(middle);
        let start = if !lit && aside >= from && window(aside) { aside } else { middle };
        // beside a gate in the middle of the wall, or nowhere in it
        let free = |start: &f64| {
            let own = Segment { start: s.point(*start), end: s.point(*start + opening) };
            !laid.iter().any(|l| meets(&l.door.line, &own))
        };
        let Some(start) = [start, from, to - opening].into_iter().find(free) else { return Vec::new() };
        let line = Segment { start: s.point(start), end: s.point(start + opening) };
        // The end of a corridor is where one looks for its door; a second exit belongs far from the first.
        let mut penalty = if spine && !self.brief.hub { meters(s.len()) } else { 0.1 * f64::from(s.at.abs()) * 0.05 };
        if main {
            let p = line.middle();
            let at = ((p.x * 40.0).round() as i32, (p.y * 40.0).round() as i32);
            penalty += TO_PUBLIC * self.to_public(p)
                + TO_ZONES * self.ill_zoned(p)
                + TO_LIVING * passed_bedrooms(self.brief, self.boxes, at);
        }
        if !main {
            let away = laid
                .iter()
                .filter(|l| l.door.entrance)
                .map(|l| l.door.line.middle().distance(line.middle()))
                .fold(f64::MAX, f64::min);
            if away < 5.0 {
                return Vec::new();
            }
            penalty -= 0.5 * away.min(100.0);
        }
        let Some(mut outward) = self.outward_spot(s, room, (start, clear), penalty) else { return Vec::new() };
        outward.door.entrance = main;
        // Doors on the way out open outwards, those of homes inwards where the leaf has floor.
        if !self.brief.is_home() || !main {
            return vec![outward];
        }
        let at_hinge = |start: f64, hinge_at_start: bool, penalty: f64| {
            let near = start - from <= to - opening - start;
            let penalty = penalty + if near == hinge_at_start { 0.0 } else { HINGE_AWAY };
            self.inward_entrance(s, room, (start, clear), hinge_at_start, penalty)
        };
        let mut spots: Vec<Spot> = [true, false].iter().filter_map(|&hinge| at_hinge(start, hinge, penalty)).collect();
        // clear of a door in the wall beside it
        for start in [from, to - opening].into_iter().filter(|start| (start - middle).abs() > ENTRANCE_SHIFT_M) {
            let shifted = penalty + ENTRANCE_SHIFTED;
            spots.extend([true, false].iter().filter_map(|&hinge| at_hinge(start, hinge, shifted)));
        }
        spots.push(Spot { penalty: penalty + OUTWARD, ..outward });
        spots
    }

    /// Returns a door to outdoors whose leaves open outwards, where one can stand before it.
    pub(super) fn outward_spot(
        &self,
        s: &Stretch,
        room: usize,
        (start, clear): (f64, f64),
        penalty: f64,
    ) -> Option<Spot> {
        let opening = Brief::opening(clear);
        let zone = self.zone(s, room, start, opening, APPROACH_M);
        let line = Segment { start: s.point(start), end: s.point(start + opening) };
        let kind = if clear >= DOUBLE_FROM_M { DoorKind::DoubleHinged } else { DoorKind::Hinged };
        let swing = Swing { into_room_id: None, hinge_at_start: true };
        let door = self.door(line, kind, clear, s, &[room], Some(swing));
        let zones = vec![(room, zone)];
        self.inside(room, &zone).then_some(Spot { door, wall: None, view: View::Company, zones, penalty })
    }

    /// Returns the entrance of a home that opens inwards, where its leaf has floor: open, it stands before no other door.
    fn inward_entrance(
        &self,
        s: &Stretch,
        room: usize,
        (start, clear): (f64, f64),
        hinge_at_start: bool,
        penalty: f64,
    ) -> Option<Spot> {
        let opening = Brief::opening(clear);
        let double = clear >= DOUBLE_FROM_M;
        let leaf = if double { opening / 2.0 } else { opening };
        let [zone, swept] = [APPROACH_M, leaf].map(|deep| self.zone(s, room, start, opening, deep));
        let mut zones = vec![(room, zone), (room, swept)];
        if !double {
            let beside = if hinge_at_start { start - BEHIND_LEAF_M } else { start + opening };
            zones.push((room, self.zone(s, room, beside, BEHIND_LEAF_M, leaf)));
        }
        let line = Segment { start: s.point(start), end: s.point(start + opening) };
        let kind = if double { DoorKind::DoubleHinged } else { DoorKind::Hinged };
        let swing = Swing { into_room_id: Some(self.brief.rooms[room].id.clone()), hinge_at_start };
        let mut door = self.door(line, kind, clear, s, &[room], Some(swing));
        door.entrance = true;
        self.inside(room, &swept).then_some(Spot { door, wall: None, view: View::Company, zones, penalty })
    }

    /// Returns how far the nearest room for visitors is from a point, or else the counter of those who see to them, m; 0 where
    /// there is neither.
    fn to_public(&self, p: Point) -> f64 {
        let nearest = |wanted: fn(&RoomSpec) -> bool| {
            let rooms = self.boxes.iter().filter(|(r, _)| wanted(&self.brief.rooms[*r]));
            let far = rooms.map(|(_, b)| {
                let c = b.to_rect().center();
                (c.x - p.x).abs() + (c.y - p.y).abs()
            });
            far.reduce(f64::min)
        };
        let public = nearest(|room| room.zone == Zone::Public);
        public.or_else(|| nearest(|room| room.zone == Zone::Staff && room.open_front)).unwrap_or(0.0)
    }

    /// Returns what the rooms lose by their distance from an entrance here, as the search for the layout counts it.
    fn ill_zoned(&self, p: Point) -> f64 {
        let size = self.net_m2.iter().sum::<f64>().sqrt().max(1.0);
        let far = |b: &Cellbox| {
            let c = b.to_rect().center();
            ((c.x - p.x).abs() + (c.y - p.y).abs()) / size
        };
        let largest = |r: usize| {
            let own = self.boxes.iter().filter(|(room, _)| *room == r).map(|(_, b)| b);
            own.max_by(|a, b| a.area_m2().total_cmp(&b.area_m2()))
        };
        let rooms = self.brief.rooms.iter().enumerate();
        rooms.filter_map(|(r, spec)| Some(ill_placed(spec, far(largest(r)?)))).sum()
    }
}
