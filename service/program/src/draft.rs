//! The steps of the reading: each takes what those before it have found, and adds to it. Their order matters: words that
//! one step has read are not read again by a later one.

use d3dgen_model::domain::{Attached, GENERIC_ROOM_TYPE, Shape};
use d3dgen_model::scene_graph::{Note, Robot};
use d3dgen_model::stage::Error;
use d3dgen_model::style::LayoutStyle;
use d3dgen_plugins::Registry;

use super::built::{vital, workers};
use super::heard::{Heard, Notes};
use super::levels::storey_wishes;
use super::levels::storeys::{self, Storeys};
use super::machines::{docks, keeps, robot_rules, robots};
use super::named::aside::Aside;
use super::named::rooms_named::Named;
use super::named::things::{self, Things};
use super::named::{compounds, styles};
use super::people::beds;
use super::people::counted::Counted;
use super::people::heads::People;
use super::people::seats::{self, Called};
use super::people::{ensuites, groups, homes, sharing, stays};
use super::subject::building::Part;
use super::subject::parts::{self, Parts};
use super::subject::programs::program_by_bedrooms;
use super::subject::site::Site;
use super::subject::{practitioners, single};
use super::tokens::text::Span;
use super::tokens::words::{Tag, words};
use super::wished::relations::{self, Said};
use super::wished::unread::Unread;
use super::wished::wishes::{self, Text, Wish, Wishes};
use super::wished::{closed, comparisons, totals, unread};
use crate::people::held::Held;
use crate::reading::Understood;
use crate::request::{MAX_ROOMS, Request, refused};

/// Robots that fetch and bring: corridors are only their way.
const CARRIES: [&str; 2] = ["delivery", "transport"];

/// A reading that is being made.
pub(crate) struct Draft<'r, 'a> {
    pub request: &'r Request,
    pub registry: &'a Registry,
    pub heard: Heard<'r>,
    pub notes: Notes,
    pub site: Site<'a>,
    pub aside: Aside,
    pub named: Named,
    pub counted: Counted,
    pub wishes: Wishes,
    /// Mentions of people who are on every storey.
    pub on_each: Vec<usize>,
}

/// Where robots stand and go.
pub(crate) struct Stops {
    /// Types of the rooms that a dock is to stand in.
    pub docked: Vec<String>,
    pub errand: robots::Errand,
}

/// What a prompt asks of its robots.
pub(crate) struct Orders {
    pub rules: Vec<robot_rules::Rule>,
    /// True where they pass each other in the corridors.
    pub two_way: bool,
}

/// What the list of rooms says of those that it does not name.
pub(crate) struct List {
    /// Rooms in total, where fixed.
    pub total: Option<u32>,
    pub single: bool,
    pub closed: bool,
    pub only: bool,
    pub may_join: bool,
    pub named_first: bool,
    /// True where the room that such a building is for joins a list that lacks it.
    pub main_joins: bool,
}

impl<'r, 'a> Draft<'r, 'a> {
    /// Reads the words: what the prompt is about, the rooms it names, and who is in them.
    ///
    /// # Errors
    /// `Refused` for prompts without words.
    pub(crate) fn of_words(request: &'r Request, registry: &'a Registry) -> Result<Self, Error> {
        let heard = Heard::of(&request.prompt, registry)?;
        let mut notes = Notes::default();
        notes.assumptions.extend(heard.spelling());
        let mut site = Site::of(&heard, request, registry, &mut notes)?;
        let mut aside = Aside::find(&heard, &mut site, registry);
        let mut named = Named::find(&heard, &site, &mut aside, registry);
        let counted = Counted::of(&heard, &site, &aside, &mut named.mentions);
        aside.not_things.extend(counted.not_things.iter().chain(&named.no_things).copied());
        for span in &named.no_things {
            let prompt = robots::Prompt { text: heard.prompt, tokens: &heard.tokens };
            let words = prompt.words(*span);
            let message =
                format!("`{words}` is an object, and these are not ruled out; rooms have what is usual in them");
            notes.conflicts.push(Note::new("unread_wish", message));
        }
        let wishes = Wishes::default();
        let on_each = Vec::new();
        Ok(Self { request, registry, heard, notes, site, aside, named, counted, wishes, on_each })
    }

    /// Returns what the prompt calls its rooms.
    pub(crate) fn called(&self) -> Vec<Called> {
        let Heard { prompt, tokens, language, spoken, .. } = &self.heard;
        seats::called(tokens, prompt, &self.named.mentions, spoken, language)
    }

    /// Returns the words for doors that are counted: "two entrances".
    pub(crate) fn doors(&mut self) -> Vec<Span> {
        unread::doors(&self.heard.tokens, &mut self.named.mentions, &self.heard.spoken)
    }

    /// Returns where the docks of robots are to stand, and where these are to go.
    pub(crate) fn stops_of_robots(&mut self) -> Stops {
        let Heard { tokens, spoken, .. } = &self.heard;
        let Site { machines, domain, .. } = &self.site;
        let mentions = &mut self.named.mentions;
        let mut docked = docks::inside_rooms(tokens, mentions, &machines.spans, spoken);
        let errand = robots::errand(machines, tokens, mentions, spoken);
        let waits = docks::where_robots_wait(tokens, mentions, &machines.spans, spoken);
        let at_door = waits.iter().any(Option::is_none);
        docked.extend(waits.into_iter().flatten().filter(|id| domain.room_type(id).is_some()));
        // what comes through the entrance is fetched there
        let by_door = errand.entrance && docked.is_empty() && self.site.lives || at_door;
        docked.extend(by_door.then(|| domain.circulation.room_type.clone()));
        Stops { docked, errand }
    }

    /// Returns the words of style that are about the building.
    pub(crate) fn styles(&mut self) -> Vec<styles::Said> {
        styles::of_building(std::mem::take(&mut self.aside.styles), &self.named.mentions, self.heard.language)
    }

    /// Returns how the rooms lie to each other.
    pub(crate) fn said_of_rooms(&mut self) -> Said {
        let Heard { tokens, language, spoken, .. } = &self.heard;
        let (domain, mentions) = (self.site.domain, &mut self.named.mentions);
        let mut said = relations::read(tokens, mentions, spoken, language, &self.site.building_words());
        groups::belong_together(tokens, mentions, domain, spoken, &mut said);
        compounds::relate(&self.aside.compounds, mentions, domain, &mut said);
        compounds::open_belongings(tokens, mentions, domain, spoken, &mut said);
        relations::keep_at_corridors(mentions, domain, &mut said);
        if self.site.lives {
            homes::share_bathrooms(tokens, mentions, domain, spoken, &mut said);
            homes::name_ensuites(mentions, &said, domain);
        }
        said
    }

    /// Makes wishes of what is named; returns the area of the building, m^2.
    pub(crate) fn wish(&mut self, said: &Said) -> Option<f64> {
        self.on_each = storey_wishes::people_on_each(&self.named.mentions, &mut self.aside.storeys);
        let Heard { prompt, tokens, language, spoken, .. } = &self.heard;
        let Self { aside, counted, notes, .. } = self;
        let Site { domain, program, .. } = self.site;
        let mentions = &self.named.mentions;
        let text = Text {
            tokens,
            prompt,
            mentions,
            said,
            short_forms: &aside.short_forms,
            areas: &aside.areas,
            list_from: self.site.building.list_from,
            robots: self.site.machines.named,
            language,
            spoken,
            storeys: &storeys::storey_of(tokens, mentions, &aside.storeys, spoken),
        };
        let mut wishes = wishes::gather(&text, &mut notes.conflicts);
        comparisons::settle(&counted.comparisons, &mut wishes, &mut notes.assumptions, &mut notes.conflicts);
        groups::house(&counted.of_groups, &mut wishes, domain);
        if self.site.lives {
            homes::add_studio(&mut wishes, program, domain);
            wishes.closed.extend(compounds::closed_rooms(tokens, mentions, domain, spoken));
        }
        wishes.enter_through_halls(domain, self.site.lives);
        wishes.open = compounds::open_rooms(tokens, mentions, domain, spoken);
        let dining = &words().dwelling.dining;
        let eats = self.site.lives && compounds::eats_where_one_lives(tokens, mentions, spoken);
        if eats && !wishes.wishes.iter().any(|w| &w.room_type == dining) {
            wishes.forbidden.push(dining.clone());
        }
        let area_m2 = totals::total_area(&text, self.request, &mut notes.conflicts);
        self.wishes = wishes;
        area_m2
    }

    /// Returns the storeys, and wishes for the rooms that are on them.
    pub(crate) fn storeys(&mut self) -> Storeys {
        let Heard { tokens, numbers, spoken, .. } = &self.heard;
        let said = storeys::Text {
            tokens,
            numbers,
            mentions: &self.named.mentions,
            phrases: &self.aside.storeys,
            spoken,
            head: self.site.building.head,
            machines: &self.site.machines.spans,
        };
        let conflicts = &mut self.notes.conflicts;
        let mut storeys = storeys::read(&said, self.site.country_code.as_deref(), conflicts);
        for &m in &self.on_each {
            let times = |n: i64| n.saturating_mul(storeys.above_ground() as i64);
            self.named.mentions[m].count = self.named.mentions[m].count.map(times);
        }
        self.furnish_storeys(&mut storeys);
        storeys
    }

    /// Wishes for what storeys have and need.
    pub(super) fn furnish_storeys(&mut self, storeys: &mut Storeys) {
        let kind = self.site.building.building_type.as_deref().and_then(|id| self.site.domain.building_type(id));
        if kind.is_some_and(|b| b.attached == Some(Attached::Flat)) {
            self.notes.assumptions.extend(storey_wishes::lie_on_one_storey(storeys, self.site.domain));
        }
        let conflicts = &mut self.notes.conflicts;
        storey_wishes::furnish_basement(storeys, &mut self.wishes, self.site.domain);
        storey_wishes::wish_for_storeys(storeys, &mut self.wishes, self.site.domain, conflicts);
    }

    /// Settles which rooms the wishes mean in such a building, and the program that goes with them.
    pub(crate) fn settle_types(&mut self) {
        let Heard { tokens, numbers, languages, spoken, .. } = &self.heard;
        let (site, wishes) = (&mut self.site, &mut self.wishes);
        ensuites::name_private_bathrooms(wishes, site.domain, site.lives);
        if !site.lives {
            vital::rule_out(site.domain, &site.wet, wishes);
            let (words, said) = ((&tokens[..], &numbers[..]), (&languages[..], &spoken[..]));
            let kinds = (site.domain, site.program);
            let read = practitioners::house(words, said, kinds, wishes, &mut self.notes.assumptions);
            self.aside.taken.extend(read);
        }
        site.program = program_by_bedrooms(site.domain, site.program, wishes);
        self.aside.taken.extend(site.building.head);
    }

    /// Returns the robots, each with where it works.
    pub(crate) fn robots(&mut self, storeys: &Storeys) -> Vec<Robot> {
        let Heard { prompt, tokens, numbers, language, spoken, .. } = &self.heard;
        let (machines, mentions) = (&self.site.machines, &self.named.mentions);
        let on_each = (&storeys.robots_on_each[..], storeys.above_ground() as u32);
        let fleet = robots::Counting { tokens, numbers, mentions, taken: &self.aside.taken, spoken, language, on_each };
        let fleet = machines.counted(&fleet);
        let heard = robots::Prompt { text: prompt, tokens };
        let Notes { assumptions, conflicts } = &mut self.notes;
        let said = (machines, &self.aside.sizes);
        let mut robots = robots::of_graph(&fleet, &self.wishes, said, self.request, &heard, assumptions, conflicts);
        let corridor = &self.site.domain.circulation.room_type;
        if let Some((span, kept)) = keeps::read(tokens, mentions, &machines.spans, corridor, spoken) {
            // what is said of the one that cleans says nothing of the one that serves
            let own = machines.kind_at(span);
            let meant = |r: &Robot| own.is_none_or(|kind| r.kind == kind) && !CARRIES.contains(&r.kind.as_str());
            robots.iter_mut().filter(|r| meant(r)).for_each(|r| r.room_types.clone_from(&kept));
        }
        robots
    }

    /// Returns what is asked of the robots in rooms; rules out the rooms that the name of the building does.
    pub(crate) fn orders_of_robots(&mut self) -> Orders {
        let Heard { tokens, numbers, language, spoken, .. } = &self.heard;
        let built = self.site.building_words();
        let rooms = relations::Reader::new(tokens, &self.named.mentions, spoken, language, &built);
        let machines = &self.site.machines.spans;
        let asked = robot_rules::read(&rooms, numbers, machines);
        self.aside.taken.extend(asked.spans);
        let wished = |id: &String| self.wishes.wishes.iter().any(|w| &w.room_type == id);
        let without: Vec<String> = self.site.building.without.iter().filter(|id| !wished(id)).cloned().collect();
        self.wishes.forbidden.extend(without);
        let two_way = robot_rules::two_way(&rooms, machines);
        self.aside.taken.extend(two_way);
        Orders { rules: asked.rules, two_way: two_way.is_some() }
    }

    /// Wishes for the rooms of departments that are named beside the building.
    pub(crate) fn departments(&mut self) -> Parts {
        let Heard { tokens, spoken, .. } = &self.heard;
        let (site, taken) = (&mut self.site, &self.aside.taken);
        // "drei Stockwerken" ends in a word for a factory
        let storey = |p: &Part| self.heard.is_tagged(p.span.start, Tag::Storeys);
        site.building.parts.retain(|p| !storey(p) && !taken.iter().any(|s| s.overlaps(p.span)));
        parts::plan(
            &site.building.parts,
            (tokens, spoken),
            &mut self.named.mentions,
            &mut self.wishes,
            (site.domain, site.program),
            &mut self.notes.assumptions,
        )
    }

    /// Returns who is in the building, and the rooms of which the prompt says how many they hold.
    pub(crate) fn people(&mut self, said: &Said, beds_of_parts: Option<u32>) -> (People, Vec<Held>) {
        let Heard { tokens, numbers, spoken, .. } = &self.heard;
        let Site { domain, program, .. } = self.site;
        let mentions = &self.named.mentions;
        let Notes { assumptions, conflicts } = &mut self.notes;
        let mut people = People::read(mentions, program, domain, conflicts);
        if self.site.lives {
            people.share_a_home(tokens, numbers, mentions, spoken);
            let head = self.site.building.head.filter(|_| self.site.shared);
            let told = head.and_then(|head| sharing::residents(tokens, numbers, head, spoken));
            people.residents = people.residents.or(told);
            return (people, Vec::new());
        }
        let who = people.occupancy.visitors.or(people.residents);
        let beds = people.occupancy.beds;
        let sleepers = beds::Sleepers { domain, program, mentions, said, beds, people: who };
        let settled = sleepers.settle(&mut self.wishes, assumptions, conflicts);
        wishes::each_of_counted(mentions, &said.each, &mut self.wishes);
        people.occupancy.beds = settled.beds.or(beds_of_parts);
        people.work_at(&self.counted);
        (people, [settled.held, self.counted.desks.clone()].concat())
    }

    /// Returns how many rooms there are to be, where that is fixed.
    ///
    /// # Errors
    /// `Refused` for more than one world has.
    pub(crate) fn total(&mut self) -> Result<Option<u32>, Error> {
        let Heard { prompt, tokens, numbers, spoken, .. } = &self.heard;
        let Site { domain, program, lives, .. } = self.site;
        let (mentions, conflicts) = (&self.named.mentions, &mut self.notes.conflicts);
        let said = self.request.rooms.or_else(|| totals::said_total(mentions));
        if lives {
            self.wishes.join_to_fit(said, domain);
            conflicts.extend(homes::state_size(said));
            if let Some((span, note)) = homes::state_several(tokens, prompt, numbers, spoken) {
                self.named.words.push(span);
                conflicts.push(note);
            }
        }
        let said = said.filter(|_| self.request.rooms.is_none());
        match workers::beside_rooms(&mut self.wishes, said, domain, program) {
            Some(rooms) => Ok(Some(rooms)),
            None => totals::total_rooms(self.request, mentions, &self.wishes, conflicts),
        }
    }

    /// Returns what the list of rooms says of the others; one room asked for by itself is all there is.
    pub(crate) fn list(&mut self, said: &Said, storeys: &Storeys, total: Option<u32>) -> List {
        let Heard { tokens, language, spoken, .. } = &self.heard;
        let Site { building, program, domain, lives, .. } = &self.site;
        let (mentions, wishes) = (&self.named.mentions, &mut self.wishes);
        let free = self.request.rooms.is_none();
        let alone = storeys.levels.len() == 1 && self.aside.short_forms.is_empty() && total.is_none_or(|n| n == 1);
        let one_room = total == Some(1) && building.head.is_none() && wishes.wishes.is_empty() && free;
        let single = alone
            && self.heard.strange.is_none()
            && (one_room || free && single::is_single(building, mentions, wishes));
        if single {
            let message = "the prompt asks for one room and no building; it was planned by itself";
            self.notes.assumptions.push(Note::new("single_room", message.into()));
            if one_room {
                wishes.wishes.push(Wish::one(GENERIC_ROOM_TYPE, "room"));
            }
        }
        let only = closed::says_only(tokens, mentions, spoken);
        let listed_only = only && !lives && wishes.wishes.iter().any(|w| w.listed);
        let arranged = said.relations.iter().any(|r| !r.belongs);
        let served = !program.support.is_empty() && !arranged;
        List {
            total: total.filter(|_| !single),
            single,
            closed: single || listed_only || closed::is_closed(wishes, tokens, building, (domain, *lives)),
            only,
            may_join: !only && closed::joins_a_name(building, tokens, language, served),
            named_first: closed::is_named_first(building, language),
            main_joins: true,
        }
    }

    /// Adds to a list of all rooms what it takes for granted.
    ///
    /// # Errors
    /// `Refused` for more rooms than one world has.
    pub(crate) fn close(&mut self, list: &List, people: &People, layout: Option<LayoutStyle>) -> Result<(), Error> {
        let Site { domain, program, lives, ref building, .. } = self.site;
        let wishes = &mut self.wishes;
        if list.closed && lives && !list.single {
            wishes.open_to(domain);
        }
        let whole = list.closed && list.total.is_none() && !list.single;
        if whole && !lives {
            let sleepers = beds::house((domain, program), &people.occupancy, people.residents, wishes);
            self.notes.assumptions.extend(sleepers);
        }
        let listed: u64 = wishes.wishes.iter().map(|w| u64::from(w.count)).sum();
        if listed > u64::from(MAX_ROOMS) {
            return Err(refused(format!(
                "the prompt asks for {listed} rooms; one world has {MAX_ROOMS} at most, ask for fewer"
            )));
        }
        if whole && list.main_joins {
            let tokens = &self.heard.tokens;
            let named = building.head.and_then(|h| self.aside.vocabulary.room_named(&tokens[h.start..h.end]));
            let desks_told = if lives { 0 } else { self.counted.desks_told() };
            let people = (people, desks_told);
            let main = closed::add_main_room(wishes, program, domain, people, named.as_deref(), layout);
            self.notes.conflicts.extend(main);
        }
        Ok(())
    }

    /// Returns true where someone stays overnight with every patient.
    pub(crate) fn stays(&mut self) -> bool {
        let Heard { tokens, spoken, .. } = &self.heard;
        let stays = if self.site.lives { None } else { stays::read(tokens, spoken) };
        self.aside.taken.extend(stays);
        stays.is_some()
    }

    /// Takes the words that say more about rooms for read.
    pub(crate) fn take_words(&mut self, called: &[Called]) {
        let words = self.named.words.iter().chain(&self.counted.words).copied();
        self.aside.taken.extend(words.chain(called.iter().map(|c| c.span)));
    }

    /// Returns the objects that the prompt names, and the words read so far.
    pub(crate) fn objects(&mut self, docked: &[String]) -> Things {
        let reader = things::Reader {
            heard: &self.heard,
            site: &self.site,
            aside: &self.aside,
            mentions: &self.named.mentions,
            registry: self.registry,
        };
        let mut found = reader.read(&mut self.wishes);
        // those stand where the prompt puts them
        let dock = |id: &str| self.site.domain.anchor(id).is_some_and(|o| o.shape == Shape::Dock);
        found.things.retain(|t| docked.is_empty() || !dock(&t.object));
        found
    }

    /// Returns where the words stand that something was made of: those for rooms and people, and others that were `read`.
    pub(crate) fn understood(&self, read: &[&[Span]]) -> Vec<Understood> {
        let found = |span: Span, room_type: Option<&str>| {
            let tokens = &self.heard.tokens.get(span.start..span.end)?;
            let bytes = tokens.first()?.start..tokens.last()?.end;
            Some(Understood { bytes, room_type: room_type.map(str::to_owned) })
        };
        let mentions = self.named.mentions.iter();
        let mentions = mentions.map(|m| found(Span { start: m.from.min(m.span.start), end: m.end() }, m.room_type()));
        let others = read.iter().copied().flatten().chain(&self.site.building.head).map(|span| found(*span, None));
        mentions.chain(others).flatten().collect()
    }

    /// States what was not read, and returns it.
    pub(crate) fn state_unread(&mut self, read: &[Span], doors: &[Span], parts: &Parts) -> Vec<Unread> {
        let Heard { prompt, tokens, numbers, spoken, .. } = &self.heard;
        let unread = unread::Text {
            tokens,
            known_language: self.heard.strange.is_none(),
            doors,
            prompt,
            numbers,
            mentions: &self.named.mentions,
            spoken,
            areas: &self.aside.areas,
            taken: read,
            list_from: self.site.building.list_from,
            planned: &parts.planned,
            parts: &parts.left,
        };
        unread::state(&unread, &mut self.notes.conflicts)
    }
}
