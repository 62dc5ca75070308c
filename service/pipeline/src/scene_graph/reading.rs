//! A prompt understood: every fact it states, before rooms are added or connected.

use std::sync::Arc;

use d3dgen_model::domain::{Access, Domain, GENERIC_ROOM_TYPE, Occupants, Program, ProgramRoom, RoomType, Shape, Zone};
use d3dgen_model::scene_graph::{Note, Occupancy, Robot};
use d3dgen_model::style::{LayoutStyle, Style, StyleWord};
use d3dgen_plugins::Registry;

use super::Request;
use super::built::layout;
use super::built::vital::{self, Wet};
use super::built::workers;
use super::levels::storeys::{self, Storeys, Wanted, Where};
use super::machines::{docks, keeps, robot_rules, robots};
use super::named::compounds;
use super::named::mentions::{Mention, Taken, Vocabulary, What, mentions};
use super::named::objects::{self, Thing};
use super::named::senses;
use super::named::styles;
use super::named::{fixtures, qualities};
use super::people::beds::{self, Held};
use super::people::seats::{self, Called};
use super::people::stations;
use super::people::{apiece, dwelling, groups, homes, seated, sharing, stays};
use super::subject::building::{self, Building};
use super::subject::parts;
use super::subject::places::{self, note};
use super::subject::practitioners;
use super::subject::{addresses, single};
use super::tokens::text::{MAX_TOKENS, Span, Token, tokens};
use super::tokens::words::{ByBedrooms, Spoken, Tag, words};
use super::tokens::{language, measures, numbers, umlauts};
use super::wished::relations;
use super::wished::subsets;
use super::wished::wishes::{self, MANY, PerHost, Text, Wish, Wishes};
use super::wished::{comparisons, unread};
use crate::Error;

/// Most rooms one world is planned for.
pub(super) const MAX_ROOMS: u32 = MANY as u32;
/// Largest building, m^2.
const MAX_AREA_M2: f64 = 200_000.0;
/// A building's first room that is so many times larger than all listed ones is what it is for.
const MAIN_ROOM_SHARE: f64 = 1.5;
/// A room for more people each is no place to work at but one to meet or wash in.
pub(super) const MOST_IN_OFFICE: u32 = 4;
/// Factor on the usual area of a kitchen that one eats in.
const EATING: f64 = 1.45;
/// Largest head count that is taken at its word.
const MAX_HEADS: i64 = 5000;

/// Robots that fetch and bring: corridors are only their way.
const CARRIES: [&str; 2] = ["delivery", "transport"];

/// Facts of a prompt.
#[derive(Clone)]
pub(super) struct Reading<'a> {
    pub language: &'static str,
    pub domain: &'a Domain,
    /// Which of its rooms have a toilet.
    pub wet: Arc<Wet>,
    pub building_type: Option<String>,
    pub program: &'a Program,
    pub country_code: Option<String>,
    pub wishes: Wishes,
    /// Rooms in total, where fixed.
    pub total: Option<u32>,
    /// True when the prompt lists all rooms there are to be.
    pub closed: bool,
    /// True for a list behind the name of a building ("ward with ..."), which what such a building is not without may join.
    pub may_join: bool,
    /// True when the prompt names the building, and the rooms behind that: lists that name none are taken at their word.
    pub named_first: bool,
    /// True when the prompt says that its list is all there is to be: "only".
    pub only: bool,
    /// True when the prompt asks for one room and no building.
    pub single: bool,
    /// Rooms of which the prompt says the beds.
    pub held: Vec<Held>,
    /// Rooms of which it says the places to be treated at.
    pub stationed: Vec<Held>,
    /// Rooms of which it says the seats or counters.
    pub seats: Vec<Held>,
    /// Types of rooms that those who work there are shared out to.
    pub halves: Vec<String>,
    /// What the prompt calls its rooms.
    pub called: Vec<Called>,
    /// True when the prompt counts the rooms to live in ("3-Zimmer-Wohnung", "2BHK").
    pub habitable_fixed: bool,
    pub area_m2: Option<f64>,
    pub occupancy: Occupancy,
    /// People who live there.
    pub residents: Option<u32>,
    /// True when all of them have a room of their own.
    pub each_alone: bool,
    /// True where two of them are a couple.
    pub pair: bool,
    pub accessible: bool,
    pub style: Style,
    pub robots: Vec<Robot>,
    /// What is asked of robots in rooms.
    pub robot_rules: Vec<robot_rules::Rule>,
    /// True where they pass each other in the corridors.
    pub two_way: bool,
    /// Types of the rooms that a dock is to stand in.
    pub docked: Vec<String>,
    /// Where the robot is to go.
    pub errand: robots::Errand,
    pub storeys: Storeys,
    /// True where someone stays overnight with every patient.
    pub stays: bool,
    /// Objects that the prompt names, each with the room type it is named with.
    pub objects: Vec<Thing>,
    /// Children who live there.
    pub children: u32,
    pub assumptions: Vec<Note>,
    pub conflicts: Vec<Note>,
}

pub(super) fn refused(message: String) -> Error {
    Error::Refused { stage: "scene_graph", message }
}

/// Reads a request.
///
/// # Errors
/// `Refused` for prompts without words, absurd sizes, unknown domains and countries.
pub(super) fn read<'a>(request: &Request, registry: &'a Registry) -> Result<Reading<'a>, Error> {
    check_flags(request, registry)?;
    let prompt = request.prompt.as_str();
    let mut tokens = tokens(prompt);
    umlauts::restore(&mut tokens, registry);
    if tokens.iter().all(Token::is_mark) {
        let message = "the prompt has no words; describe a building, for instance `two-bedroom flat in Germany`";
        return Err(refused(message.into()));
    }
    let language = language::detect(&tokens, |code| building::words_known(&tokens, registry, code));
    let languages: Vec<&str> = if language == "en" { vec!["en"] } else { vec![language, "en"] };
    let spoken: Vec<&Spoken> = languages.iter().filter_map(|l| words().languages.get(*l)).collect();
    let numbers = numbers::numbers(&tokens, language, &spoken);
    let mut place = places::locate(&tokens, prompt, &spoken);
    place.spans.extend(addresses::find(&tokens, &spoken));
    let (mut assumptions, mut conflicts) = (place.assumptions, place.conflicts);
    if tokens.len() >= MAX_TOKENS {
        conflicts.push(note("prompt_cut", format!("only the first {MAX_TOKENS} words of the prompt were read")));
    }
    let flag_country = request.country.as_deref().and_then(places::code_of);
    if let (Some(flag), Some(named)) = (&flag_country, &place.country_code)
        && flag != named
    {
        conflicts.push(note("country_flag", format!("the prompt says {named}, the request {flag}; {flag} was used")));
    }
    if flag_country.is_some() {
        conflicts.retain(|n| n.code != "ambiguous_place" && n.code != "unknown_place");
    }
    let machines = robots::find(&tokens, &spoken, language);
    // neither places nor robots and their docks say what is built
    let elsewhere: Vec<Span> = place.spans.iter().chain(&machines.spans).chain(&machines.docks).copied().collect();
    let mut building = building_of(
        request,
        registry,
        &tokens,
        &languages,
        &spoken,
        &numbers,
        &elsewhere,
        &mut assumptions,
        &mut conflicts,
    );
    if place.country_code.is_none() && conflicts.iter().all(|n| !n.code.ends_with("_place")) {
        let (code, span) = places::of_building(&tokens, &spoken, (language, &building.words), &mut assumptions).unzip();
        place.country_code = code;
        place.spans.extend(span);
    }
    let words_known = || building::words_known(&tokens, registry, language);
    let unread_language = language::unread(prompt, &tokens, language, words_known());
    if let Some(name) = unread_language {
        let message = format!(
            "the prompt seems to be in {name}, which is not read; only what looks like a language that is was taken from it (English, German, French, Spanish, Chinese, Korean)"
        );
        assumptions.push(note("language_not_read", message));
    }
    let domain =
        registry.get(&building.domain).map(|p| p.domain()).ok_or_else(|| refused("no domain is registered".into()))?;
    let program = program_of(domain, building.building_type.as_deref());

    let shared = building.building_type.as_ref().is_some_and(|b| words().dwelling.shared.contains(b));
    let areas = measures::areas(&tokens, &numbers);
    let radius = measures::robot_radius(&tokens, &numbers, &spoken);
    let length = measures::robot_length(&tokens, &numbers, &spoken).filter(|_| radius.is_some());
    let mut short_forms = dwelling::short_forms(&tokens, &numbers, domain, &spoken, shared);
    let place_spans = place.spans.clone();
    let mut spans: Vec<Span> = std::mem::take(&mut place.spans);
    spans.extend(areas.iter().map(|a| a.span));
    spans.extend(short_forms.iter().map(|f| f.span));
    let mut counted: Vec<Span> = spans.iter().filter(|s| !place_spans.contains(s)).copied().collect();
    counted.extend(machines.spans.iter().copied());
    spans.extend(machines.spans.iter().copied());
    spans.extend(radius.iter().chain(&length).map(|r| r.0));
    let vocabulary =
        registry.digest(&format!("{languages:?}: {}", domain.id), || Vocabulary::new(domain, registry, &languages));
    single::unname(&mut building, &tokens, &vocabulary, &numbers, &spoken);
    let lives = is_dwelling(program);
    let choice = beds::Choice { domain, program, spoken: &spoken };
    let told = if lives { Vec::new() } else { choice.phrases(&tokens, &numbers, |s| vocabulary.own_at(&tokens, s)) };
    let room_end = |i: usize| vocabulary.room_end(&tokens, i, &numbers, &spoken);
    let within = |id: &String| words().dwelling.within_a_storey.contains(id);
    let basements = !building.building_type.as_ref().is_some_and(within);
    let storey_phrases = storeys::phrases(&tokens, &numbers, &spoken, building.head, basements, room_end);
    spans.extend(storey_phrases.iter().map(|p| p.span));
    // "an agency with open space for 20 people": in a list it is a room
    let list_from = building.list_from;
    let is_room = |s: Span| list_from > 0 && s.start >= list_from && vocabulary.own_at(&tokens, s).is_some();
    let mut said_styles = styles::said(&tokens, &languages);
    said_styles.retain(|s| !is_room(s.span));
    // "open-plan flat"
    if let Some(head) = building.head.filter(|_| lives) {
        let before = |i: &usize| spoken.iter().any(|s| s.tag_at(&tokens, *i, Tag::OpenPlan) == Some(head.start));
        let open = (0..head.start).find(before).map(|start| Span { start, end: head.start });
        said_styles.extend(open.map(|span| styles::Said { span, word: StyleWord::Layout(LayoutStyle::Open) }));
    }
    spans.extend(said_styles.iter().map(|s| s.span));
    // "home office corner": a place in a room
    let nooks = if lives {
        qualities::nooks(&tokens, &spoken, domain, |i| spans.iter().any(|s| s.contains(i)))
    } else {
        Vec::new()
    };
    spans.extend(nooks.iter().map(|n| n.span));
    // "cleaning robot" and "wheelchair users" name no object
    let mut not_things = machines.spans.clone();
    not_things.extend(said_styles.iter().map(|s| s.span));
    not_things.extend(nooks.iter().map(|n| n.span));
    not_things.extend(access_wishes(&tokens, &numbers, &spoken));
    let names_room = |i: usize| vocabulary.names_room(&tokens, i, &numbers, &spoken);
    let compounds = compounds::find(&tokens, prompt, domain, &spoken, names_room, |span| {
        spans.iter().chain(&building.head).any(|s| s.overlaps(span))
    });
    let taken = Taken {
        spans: &spans,
        head: building.head,
        buildings: &building.words,
        list_from: building.list_from,
        counted: &counted,
        docks: &machines.docks,
        bed_rooms: &told,
        compounds: &compounds,
        unread: unread_language.is_some(),
    };
    let mut mentions = mentions(&tokens, &numbers, &vocabulary, &spoken, language, &taken);
    docks::not_of_goods(&tokens, &mut mentions, domain, &spoken);
    unread::uncount_measures(&tokens, &mut mentions, &spoken);
    let wet = registry.digest(&domain.id, || Wet::of(domain));
    let mut told_again = compounds::hold_own(&tokens, prompt, &compounds, &mut mentions, domain, &spoken);
    if lives {
        told_again.extend(fixtures::settle(&tokens, prompt, &mut mentions, domain, &wet, &spoken));
        told_again.extend(objects::of_bedrooms(&tokens, &mut mentions, (domain, registry), (&languages, &spoken)));
        told_again.extend(homes::sleep_where_one_lives(&tokens, &mut mentions, (domain, program), &spoken));
        homes::not_of_things(&tokens, &mut mentions, (domain, registry), (&languages, &spoken));
    }
    let sleeps = |id: &str| domain.room_type(id).is_some_and(|k| k.zone == Zone::Night);
    let own_room = lives.then(|| sharing::each_has_a_room(&tokens, &mentions, &spoken, sleeps)).flatten();
    if let Some(span) = own_room {
        // "everybody has a private room" names no room of another kind
        let own = |m: &Mention| spoken.iter().any(|s| s.tag_at(&tokens, m.span.start, Tag::Own).is_some());
        let said = |m: &Mention| m.room_type().is_some_and(|id| sleeps(id) || own(m));
        mentions.retain(|m| !(span.contains(m.span.start) && said(m)));
        told_again.push(span);
    }
    homes::count_listed(&mut short_forms, &mentions, domain);
    // "three-room flat: living room with kitchen corner": it is the one that the number counts
    let habitable_fixed = short_forms.iter().any(|f| f.rooms.contains_key(&words().dwelling.living));
    let named = |id: &String| mentions.iter().any(|m| m.room_type() == Some(id));
    if named(&words().dwelling.living_kitchen) && !named(&words().dwelling.living) {
        short_forms.iter_mut().for_each(|f| {
            f.rooms.remove(&words().dwelling.living);
        });
    }
    if !lives {
        choice.read_lists(&tokens, &mut mentions);
        choice.adopt(&mut mentions);
        let wards: Vec<Span> = building.words.iter().chain(&building.head).copied().collect();
        beds::of_several_wards(&mut mentions, &numbers, &wards);
    }
    senses::settle(&tokens, &mut mentions, &vocabulary, &spoken, (domain, program));
    subsets::settle(&tokens, &numbers, &spoken, &mut mentions, domain);
    let (mut seated, desk_words) =
        if lives { Default::default() } else { seated::read(&tokens, &mut mentions, (domain, program), &spoken) };
    let apiece = apiece::Reader {
        tokens: &tokens,
        numbers: &numbers,
        domain,
        program,
        spoken: &spoken,
        list_from: building.list_from,
    };
    let (titled_offices, titled_heads) = apiece.by_title(&mut mentions);
    seated.extend(titled_offices);
    seated.extend(apiece.by_number(&mentions));
    let (single_offices, apiece_words) = apiece.each_an_office(&mut mentions);
    seated.extend(single_offices);
    let (shared_offices, sharing_words) = apiece.one_for_all(&mut mentions);
    seated.extend(shared_offices);
    let of_groups = groups::Reader { tokens: &tokens, numbers: &numbers, domain, program, spoken: &spoken };
    let of_groups = of_groups.read(&mut mentions);
    seated.extend(of_groups.held);
    told_again.extend(of_groups.spans);
    let rooms_of_groups = of_groups.rooms;
    let (compared, compared_words) = comparisons::read(&tokens, &mut mentions, &spoken);
    told_again.extend(compared_words);
    let elsewhere: Vec<Span> = machines.spans.iter().chain(&place_spans).chain(&building.head).copied().collect();
    let stations = stations::Reader {
        tokens: &tokens,
        numbers: &numbers,
        vocabulary: &vocabulary,
        domain,
        program,
        spoken: &spoken,
        taken: &elsewhere,
    };
    let station_words = if lives { Vec::new() } else { stations.read(&mut mentions) };
    not_things.extend(station_words.iter().copied());
    let places = seats::Reader {
        tokens: &tokens,
        numbers: &numbers,
        domain,
        program,
        spoken: &spoken,
        taken: &elsewhere,
        seated: &seated,
    };
    let mut places = if lives { seats::Found::default() } else { places.read(&mut mentions) };
    let open_desks = apiece.desks_of_the_list(&mut mentions, &desk_words);
    let counts_desks = open_desks.is_some();
    seated.extend(open_desks);
    not_things.extend(places.spans.iter().copied());
    let stationed = mentions.iter().filter_map(|m| {
        Some(Held {
            room_type: m.room_type()?.to_owned(),
            count: m.count.map_or(1, |n| n.max(1) as u32),
            beds: m.places?,
        })
    });
    let stationed: Vec<Held> = stationed.collect();
    let seated: Vec<Held> = seated.into_iter().chain(std::mem::take(&mut places.desks)).collect();
    let called = seats::called(&tokens, prompt, &mentions, &spoken, language);
    let doors = unread::doors(&tokens, &mut mentions, &spoken);
    let mut docked = docks::inside_rooms(&tokens, &mut mentions, &machines.spans, &spoken);
    let errand = robots::errand(&machines, &tokens, &mentions, &spoken);
    // what comes through the entrance is fetched there
    let waits = docks::where_robots_wait(&tokens, &mut mentions, &machines.spans, &spoken);
    let at_door = waits.iter().any(Option::is_none);
    let waits_in = waits.into_iter().flatten();
    docked.extend(waits_in.filter(|id| domain.room_type(id).is_some()));
    let by_door = errand.entrance && docked.is_empty() && lives || at_door;
    docked.extend(by_door.then(|| domain.circulation.room_type.clone()));
    let said_styles = styles::of_building(said_styles, &mentions, language);
    let built: Vec<Span> = building.words.iter().chain(&building.head).copied().collect();
    let mut said = relations::read(&tokens, &mentions, &spoken, language, &built);
    groups::belong_together(&tokens, &mentions, domain, &spoken, &mut said);
    compounds::relate(&compounds, &mentions, domain, &mut said);
    compounds::open_belongings(&tokens, &mentions, domain, &spoken, &mut said);
    if lives {
        homes::share_bathrooms(&tokens, &mentions, domain, &spoken, &mut said);
        homes::name_ensuites(&mut mentions, &said, domain);
    }
    let arranged = said.relations.iter().any(|r| !r.belongs);
    let storey_of = storeys::storey_of(&tokens, &mentions, &storey_phrases, &spoken);
    let text = Text {
        tokens: &tokens,
        prompt,
        mentions: &mentions,
        said: &said,
        short_forms: &short_forms,
        areas: &areas,
        list_from: building.list_from,
        robots: machines.named,
        language,
        spoken: &spoken,
        storeys: &storey_of,
    };
    let mut wishes = wishes::gather(&text, &mut conflicts);
    comparisons::settle(&compared, &mut wishes, &mut assumptions, &mut conflicts);
    groups::house(&rooms_of_groups, &mut wishes, domain);
    if lives {
        homes::add_studio(&mut wishes, program, domain);
        wishes.closed.extend(compounds::closed_rooms(&tokens, &mentions, domain, &spoken));
        wishes.enter_through_halls(domain);
    }
    wishes.open = compounds::open_rooms(&tokens, &mentions, domain, &spoken);
    let dining = &words().dwelling.dining;
    if lives
        && compounds::eats_where_one_lives(&tokens, &mentions, &spoken)
        && !wishes.wishes.iter().any(|w| &w.room_type == dining)
    {
        wishes.forbidden.push(dining.clone());
    }
    let area_m2 = total_area(&text, request, &mut conflicts);
    let country = flag_country.as_deref().or(place.country_code.as_deref());
    let said_storeys = storeys::Text {
        tokens: &tokens,
        numbers: &numbers,
        mentions: &mentions,
        phrases: &storey_phrases,
        spoken: &spoken,
        head: building.head,
        machines: &machines.spans,
    };
    let mut storeys = storeys::read(&said_storeys, country, &mut conflicts);
    furnish_basement(&mut storeys, &mut wishes, domain);
    wish_for_storeys(&mut storeys, &mut wishes, domain, &mut conflicts);
    name_private_bathrooms(&mut wishes, domain, lives);
    if !lives {
        vital::rule_out(domain, &wet, &mut wishes);
        let (words, said) = ((&tokens[..], &numbers[..]), (&languages[..], &spoken[..]));
        spans.extend(practitioners::house(words, said, (domain, program), &mut wishes, &mut assumptions));
    }
    let program = program_by_bedrooms(domain, program, &wishes);
    spans.extend(building.head);
    let fleet = robots::Counting {
        tokens: &tokens,
        numbers: &numbers,
        mentions: &mentions,
        taken: &spans,
        spoken: &spoken,
        language,
        on_each: (&storeys.robots_on_each, storeys.above_ground() as u32),
    };
    let fleet = machines.counted(&fleet);
    let heard = robots::Prompt { text: prompt, tokens: &tokens };
    let (radius, length) = (radius.map(|r| r.1), length.map(|l| l.1));
    let size = (radius, length);
    let mut robots = robots::of_graph(&fleet, &wishes, size, request, &heard, &mut assumptions, &mut conflicts);
    let kept = keeps::read(&tokens, &mentions, &machines.spans, &domain.circulation.room_type, &spoken);
    if let Some((span, kept)) = kept {
        // what is said of the one that cleans says nothing of the one that serves
        let own = machines.kind_at(span);
        let meant = |r: &Robot| own.is_none_or(|kind| r.kind == kind) && !CARRIES.contains(&r.kind.as_str());
        robots.iter_mut().filter(|r| meant(r)).for_each(|r| r.room_types.clone_from(&kept));
    }
    let rooms = relations::Reader::new(&tokens, &mentions, &spoken, language, &built);
    let asked = robot_rules::read(&rooms, &numbers, &machines.spans);
    spans.extend(asked.spans);
    let wished = |id: &String| wishes.wishes.iter().any(|w| &w.room_type == id);
    let without: Vec<String> = building.without.iter().filter(|id| !wished(id)).cloned().collect();
    wishes.forbidden.extend(without);
    let two_way = robot_rules::two_way(&rooms, &machines.spans);
    spans.extend(two_way);
    // "drei Stockwerken" ends in a word for a factory
    let storey = |p: &building::Part| spoken.iter().any(|s| s.tag_at(&tokens, p.span.start, Tag::Storeys).is_some());
    building.parts.retain(|p| !storey(p) && !spans.iter().any(|s| s.overlaps(p.span)));
    let parts = parts::plan(
        &building.parts,
        (&tokens, &spoken),
        &mut mentions,
        &mut wishes,
        (domain, program),
        &mut assumptions,
    );
    let mut people = People::read(&mentions, program, domain, &mut conflicts);
    let (mut held, mut desks_told) = (Vec::new(), 0);
    let each_alone = lives && (shared || own_room.is_some());
    if lives {
        people.share_a_home(&tokens, &numbers, &mentions, &spoken);
        let head = building.head.filter(|_| shared);
        let told = head.and_then(|head| sharing::residents(&tokens, &numbers, head, &spoken));
        people.residents = people.residents.or(told);
    } else {
        let who = people.occupancy.visitors.or(people.residents);
        let beds = people.occupancy.beds;
        let sleepers = beds::Sleepers { domain, program, mentions: &mentions, said: &said, beds, people: who };
        let settled = sleepers.settle(&mut wishes, &mut assumptions, &mut conflicts);
        wishes::each_of_counted(&mentions, &said.each, &mut wishes);
        (held, people.occupancy.beds) = (settled.held, settled.beds.or(parts.beds));
        if titled_heads > 0 {
            people.occupancy.staff = people.occupancy.staff.max(Some(titled_heads));
        }
        let desks: u32 = seated.iter().map(|s| s.count.saturating_mul(s.beds)).fold(0, u32::saturating_add);
        desks_told = desks;
        let heads = &mut people.occupancy;
        let counted = if heads.desks.is_some() || counts_desks { &mut heads.desks } else { &mut heads.staff };
        if counted.is_some() || counts_desks {
            *counted = (*counted).max(Some(desks));
        }
        held.extend(seated);
    }
    let said = request.rooms.or_else(|| said_total(&mentions));
    if lives {
        wishes.join_to_fit(said, domain);
        conflicts.extend(homes::state_size(said));
        if let Some((span, note)) = homes::state_several(&tokens, prompt, &numbers, &spoken) {
            told_again.push(span);
            conflicts.push(note);
        }
    }
    let beside = workers::beside_rooms(&mut wishes, said.filter(|_| request.rooms.is_none()), domain, program);
    let total = beside.map_or_else(|| total_rooms(request, &mentions, &wishes, &mut conflicts), |n| Ok(Some(n)))?;
    let alone = storeys.levels.len() == 1 && short_forms.is_empty() && total.is_none_or(|n| n == 1);
    let alone = alone && unread_language.is_none();
    let one_room = total == Some(1) && building.head.is_none() && wishes.wishes.is_empty() && request.rooms.is_none();
    let single = alone && (one_room || request.rooms.is_none() && single::is_single(&building, &mentions, &wishes));
    if single {
        assumptions
            .push(note("single_room", "the prompt asks for one room and no building; it was planned by itself".into()));
    }
    if single && one_room {
        wishes.wishes.push(Wish::one(GENERIC_ROOM_TYPE, "room"));
    }
    let total = total.filter(|_| !single);
    let only = says_only(&tokens, &mentions, &spoken);
    let listed_only = only && !lives && wishes.wishes.iter().any(|w| w.listed);
    let style = styles::wished(&said_styles, request.style, &mut conflicts);
    let closed = single || listed_only || is_closed(&wishes, &tokens, &building, (domain, lives));
    let may_join = !only && joins_a_name(&building, &tokens, language, !program.support.is_empty() && !arranged);
    let named_first = is_named_first(&building, language);
    if closed && lives && !single {
        wishes.open_to(domain);
    }
    if closed && total.is_none() && !single && !lives {
        assumptions.extend(beds::house((domain, program), &people.occupancy, people.residents, &mut wishes));
    }
    let listed: u64 = wishes.wishes.iter().map(|w| u64::from(w.count)).sum();
    if listed > u64::from(MAX_ROOMS) {
        return Err(refused(format!(
            "the prompt asks for {listed} rooms; one world has {MAX_ROOMS} at most, ask for fewer"
        )));
    }
    if closed && total.is_none() && !single {
        let named = building.head.and_then(|h| vocabulary.room_named(&tokens[h.start..h.end]));
        let people = (&people, desks_told);
        assumptions.extend(add_main_room(&mut wishes, program, domain, people, named.as_deref(), style.layout));
    }
    spans.extend(station_words);
    spans.extend(told_again);
    spans.extend(apiece_words);
    spans.extend(sharing_words);
    spans.extend(places.spans);
    spans.extend(called.iter().map(|c| c.span));
    let stays = if lives { None } else { stays::read(&tokens, &spoken) };
    spans.extend(stays);
    let mut read: Vec<Span> = spans.iter().chain(&machines.docks).chain(&building.words).copied().collect();
    // "ein Geschoss"
    let storeys_told = |start: usize| {
        spoken.iter().find_map(|s| s.storey_counts.longest_at(&tokens, start)).map(|f| Span { start, end: f.0 })
    };
    read.extend((0..tokens.len()).filter_map(storeys_told));
    let mut things =
        objects::named(&tokens, &mentions, (domain, registry), (&languages, &spoken), &not_things, &mut read);
    if lives {
        homes::furnish_entrance(&things, &mut wishes, domain);
    }
    let free = |i: usize| !spans.iter().chain(&building.head).any(|s| s.contains(i));
    let mut furnished = qualities::furnished(&tokens, &spoken, free);
    // who shares a home eats in its kitchen
    let [kitchen, table] = &words().dwelling.shared_meals;
    furnished.extend(shared.then(|| (table.clone(), kitchen.clone(), Span { start: 0, end: 0 })));
    let dines = wishes.wishes.iter().any(|w| w.room_type == words().dwelling.dining);
    for (object, room_type, span) in furnished {
        let here = domain.object(&object).is_some() && wishes.wishes.iter().any(|w| w.room_type == room_type);
        if here && !things.iter().any(|t| t.object == object) {
            read.push(span);
            let wish = wishes.wishes.iter_mut().find(|w| w.room_type == room_type);
            wish.into_iter().filter(|_| !dines).for_each(|w| w.size = w.size.or(Some(EATING)));
            things.push(Thing::of_one(&object, Some(room_type)));
        }
    }
    for nook in nooks {
        let wished = |id: &&String| wishes.wishes.iter().any(|w| w.room_type == **id);
        let said = homes::room_of_nook(&tokens, &mentions, &nook, &spoken);
        let room_type = said.or(nook.room_types.iter().find(wished)).or(nook.room_types.first()).cloned();
        if !things.iter().any(|t| t.object == nook.object) {
            things.push(Thing::of_one(&nook.object, room_type));
        }
    }
    if lives {
        things.extend(dwelling::cradle(&tokens, &mentions, &wishes, (domain, &things), &spoken, &mut read));
    }
    let unread = unread::Text {
        tokens: &tokens,
        known_language: unread_language.is_none(),
        doors: &doors,
        prompt,
        numbers: &numbers,
        mentions: &mentions,
        spoken: &spoken,
        areas: &areas,
        taken: &read,
        list_from: building.list_from,
        planned: &parts.planned,
        parts: &parts.left,
    };
    unread::state(&unread, &mut conflicts);
    let says = |tag| (0..tokens.len()).any(|i| spoken.iter().any(|s| s.tag_at(&tokens, i, tag).is_some()));
    // those stand where the prompt puts them
    things.retain(|t| docked.is_empty() || domain.anchor(&t.object).is_none_or(|o| o.shape != Shape::Dock));
    Ok(Reading {
        language,
        domain,
        wet,
        building_type: building.building_type,
        program,
        country_code: flag_country.or(place.country_code),
        storeys,
        stays: stays.is_some(),
        objects: things,
        wishes,
        total,
        closed,
        may_join,
        named_first,
        only,
        single,
        held,
        stationed,
        seats: places.seats,
        halves: places.halves,
        called,
        habitable_fixed,
        area_m2,
        occupancy: people.occupancy,
        residents: people.residents,
        children: people.children,
        pair: people.pair,
        each_alone,
        accessible: says(Tag::Accessible) || lives && says(Tag::Frail),
        robots,
        robot_rules: asked.rules,
        two_way: two_way.is_some(),
        docked,
        errand,
        style,
        assumptions,
        conflicts,
    })
}

fn check_flags(request: &Request, registry: &Registry) -> Result<(), Error> {
    if let Some(id) = &request.domain
        && registry.get(id).is_none()
    {
        let known: Vec<&str> = registry.iter().map(|p| p.id()).collect();
        return Err(refused(format!("domain `{id}` is not known; known are {}", known.join(", "))));
    }
    if let Some(country) = &request.country
        && places::code_of(country).is_none()
    {
        return Err(refused(format!("country `{country}` is not known; give an ISO 3166-1 code such as DE or US")));
    }
    if let Some(problem) = request.robot.problems().into_iter().next() {
        return Err(refused(problem));
    }
    if let Some(n) = request.rooms.filter(|n| !(1..=MAX_ROOMS).contains(n)) {
        return Err(refused(format!("{n} rooms were asked for; one world has 1 to {MAX_ROOMS} rooms")));
    }
    if let Some(area) = request.area_m2.filter(|a| !(a.is_finite() && (5.0..=MAX_AREA_M2).contains(a))) {
        return Err(refused(format!("an area of {area} m2 was asked for; one world has 5 to {MAX_AREA_M2} m2")));
    }
    if let Some(radius) = request.robot_radius_m.filter(|r| !(r.is_finite() && (0.05..=2.0).contains(r))) {
        return Err(refused(format!("a robot radius of {radius} m was asked for; it must be 0.05 to 2 m")));
    }
    Ok(())
}

#[expect(clippy::too_many_arguments, reason = "the parts of one prompt, each read by its own module")]
fn building_of(
    request: &Request,
    registry: &Registry,
    tokens: &[Token],
    languages: &[&str],
    spoken: &[&Spoken],
    numbers: &[numbers::Number],
    places: &[Span],
    assumptions: &mut Vec<Note>,
    conflicts: &mut Vec<Note>,
) -> Building {
    let recognize = |only| building::recognize(tokens, registry, languages, spoken, numbers, places, only);
    let mut found = recognize(None);
    if found.as_ref().is_none_or(|b| b.by_rooms) {
        // "a 4-bed room" is no home, and who has staff works there
        let by_words = by_beds_or_staff(registry, tokens, numbers, spoken, found.is_none());
        found = by_words.map(|domain| Building { by_rooms: true, ..Building::none(domain) }).or(found);
        found = practitioners::practice_of(registry, (tokens, numbers), languages).or(found);
    }
    if let Some(id) = &request.domain {
        if let Some(other) = found.as_ref().filter(|b| &b.domain != id && !b.by_rooms) {
            let message =
                format!("the prompt reads like domain {}, the request says {id}; {id} was used", other.domain);
            conflicts.push(note("domain_flag", message));
        }
        let head = found.as_ref().and_then(|b| b.head);
        let list_from = found.as_ref().map_or(0, |b| b.list_from);
        return match recognize(Some(id)) {
            Some(b) => b,
            None => Building { head, list_from, ..Building::none(id) },
        };
    }
    match found {
        Some(building) => {
            if building.by_rooms {
                let message = format!("the prompt names no building; its rooms suggest domain {}", building.domain);
                assumptions.push(note("domain_from_rooms", message));
            }
            building
        }
        None => {
            let id = registry.iter().next().map_or(String::new(), |p| p.id().to_owned());
            let title = registry.get(&id).map_or(String::new(), |p| p.domain().title.to_lowercase());
            let message = format!("the prompt does not say what to build; domain {id} was taken");
            assumptions.push(note("default_domain", message));
            let unread: Vec<&str> = unread::nouns(tokens, numbers, spoken, places)
                .into_iter()
                .filter_map(|t| request.prompt.get(t.start..t.end))
                .collect();
            if !unread.is_empty() {
                let message = format!(
                    "of `{}` no word names a building or room that is known; the usual {title} building was planned, say what it is (a flat, an office, a ward, a school)",
                    unread.join("`, `")
                );
                conflicts.push(note("unknown_building", message));
            }
            Building::none(&id)
        }
    }
}

/// Returns the domain of rooms that are told by their beds, and where nothing else tells one that of people who work.
fn by_beds_or_staff<'a>(
    registry: &'a Registry,
    tokens: &[Token],
    numbers: &[numbers::Number],
    spoken: &[&Spoken],
    nothing: bool,
) -> Option<&'a str> {
    let domains =
        || registry.iter().map(|p| p.domain()).filter(|d| d.programs.first().is_some_and(|p| !is_dwelling(p)));
    let tagged = |tag| (0..tokens.len()).any(|i| spoken.iter().any(|s| s.tag_at(tokens, i, tag).is_some()));
    if let Some(count) = beds::told(tokens, numbers, spoken) {
        return domains().find(|d| beds::has_room_for(d, count)).map(|d| d.id.as_str());
    }
    let works = nothing && [Tag::Staff, Tag::StaffBefore, Tag::Desks].into_iter().any(tagged);
    let seats =
        |d: &&Domain| d.programs.first().is_some_and(|p| p.rooms.iter().any(|r| r.area_per_occupant_m2.is_some()));
    domains().find(seats).filter(|_| works).map(|d| d.id.as_str())
}

fn program_of<'a>(domain: &'a Domain, building_type: Option<&str>) -> &'a Program {
    building_type
        .and_then(|id| domain.building_types.iter().find(|b| b.id == id))
        .and_then(|b| domain.program(&b.program))
        .or_else(|| domain.programs.first())
        .expect("a domain's check demands a program")
}

/// Returns the program of a home with as many bedrooms as the prompt gives it.
fn program_by_bedrooms<'a>(domain: &'a Domain, program: &'a Program, wishes: &Wishes) -> &'a Program {
    let bedrooms = wishes.wishes.iter().find(|w| w.exact && w.room_type == words().dwelling.bedroom).map(|w| w.count);
    let own = |b: &&ByBedrooms| b.programs.contains(&program.id) && Some(b.bedrooms) == bedrooms;
    let other = words().dwelling.by_bedrooms.iter().find(own).and_then(|b| domain.program(&b.program));
    other.unwrap_or(program)
}

/// Counts rooms on every storey for each of them, and leaves stairs and elevators to what joins the storeys.
fn wish_for_storeys(storeys: &mut Storeys, wishes: &mut Wishes, domain: &Domain, conflicts: &mut Vec<Note>) {
    let rules = domain.circulation.storeys.as_ref();
    let climbs = |id: &str| rules.is_some_and(|r| goes_up(domain, id, &r.stairs.room_type));
    if storeys.levels.len() < 2 {
        // "a core with lifts and stairs" on one storey has one of them
        let stairs = wishes.wishes.iter_mut().filter(|w| !w.exact && climbs(&w.room_type));
        stairs.for_each(|w| w.count = 1);
        return;
    }
    let above = storeys.above_ground() as u32;
    let mut sums: Vec<(&str, u32)> = Vec::new();
    for wanted in &storeys.wanted {
        let count = if wanted.at == Where::Each { wanted.count * above } else { wanted.count };
        match sums.iter_mut().find(|s| s.0 == wanted.room_type) {
            Some(sum) => sum.1 += count,
            None => sums.push((&wanted.room_type, count)),
        }
    }
    for wish in &mut wishes.wishes {
        if let Some((_, sum)) = sums.iter().find(|s| s.0 == wish.room_type) {
            wish.count = wish.count.max(*sum);
        }
    }
    if let Some(rules) = rules {
        let lifts = |id: &str| rules.elevator.as_ref().is_some_and(|e| goes_up(domain, id, &e.room_type));
        let joins = |id: &String| climbs(id) || lifts(id);
        let stairs = wishes.wishes.iter().filter(|w| w.exact && climbs(&w.room_type)).map(|w| w.count).max();
        storeys.stairs = stairs.unwrap_or(0);
        storeys.elevator = storeys.elevator.or(wishes.wishes.iter().any(|w| lifts(&w.room_type)).then_some(true));
        storeys.wanted.retain(|w| !joins(&w.room_type));
        wishes.wishes.retain(|w| !joins(&w.room_type));
        for pair in wishes.pairs.iter().filter(|p| joins(&p.a) || joins(&p.b)) {
            let [a, b] = [&pair.a, &pair.b].map(|id| id.replace('_', " "));
            let why = "stairs and elevators stand where they join the storeys";
            conflicts.push(note("not_beside", format!("{a} and {b} were not planned beside each other: {why}")));
        }
        wishes.pairs.retain(|p| !joins(&p.a) && !joins(&p.b));
        wishes.forbidden.retain(|f| !joins(f));
    }
    // what joins the rooms of a storey cannot be ruled out
    wishes.forbidden.retain(|f| *f != domain.circulation.room_type);
}

/// Returns true for rooms that lead to other storeys as those of a type do: "two staircases" are what joins the storeys,
/// whatever room a building of one storey has for that.
fn goes_up(domain: &Domain, id: &str, of: &str) -> bool {
    let spaces = |id: &str| domain.room_type(id).map_or(&[][..], |k| &k.spaces);
    let known = domain.room_type(id);
    // "stair" is the word of another domain for the same
    let same = known.is_none() && spaces(of).iter().any(|s| s == id);
    let circulates = known.is_some_and(|k| k.zone == Zone::Circulation);
    id == of || same || circulates && spaces(id).iter().any(|s| spaces(of).contains(s))
}

/// Head counts of a prompt.
struct People {
    occupancy: Occupancy,
    residents: Option<u32>,
    children: u32,
    /// True where two are a couple.
    pair: bool,
}

impl People {
    fn read(mentions: &[Mention], program: &Program, domain: &Domain, conflicts: &mut Vec<Note>) -> Self {
        let mut count = |what: &What| {
            let n = mentions.iter().filter(|m| &m.what == what && !m.article).filter_map(|m| m.count).max()?;
            if !(1..=MAX_HEADS).contains(&n) {
                conflicts.push(note(
                    "impossible_count",
                    format!("a head count of {n} was left out; 1 to {MAX_HEADS} can be planned"),
                ));
                return None;
            }
            u32::try_from(n).ok()
        };
        let people = count(&What::People);
        let mut occupancy = Occupancy {
            staff: count(&What::Staff),
            beds: count(&What::Beds),
            desks: count(&What::Desks),
            visitors: count(&What::Visitors),
            residents: None,
        };
        let mut residents = count(&What::Residents);
        // "for 40 people": those who live in a dwelling, work where the program seats staff, visit anywhere else
        let lives = domain.room_type(&words().dwelling.bedroom).is_some() && is_dwelling(program);
        let seats = |r: &ProgramRoom| r.area_per_occupant_m2.is_some() || r.occupants_per_room.is_some();
        let works = program.rooms.iter().any(|r| r.occupants == Occupants::Staff && seats(r));
        match people {
            Some(n) if lives => residents = residents.or(Some(n)),
            Some(n) if works => occupancy.staff = occupancy.staff.or(Some(n)),
            Some(n) => occupancy.visitors = occupancy.visitors.or(Some(n)),
            None => {}
        }
        Self { occupancy, residents, children: 0, pair: false }
    }

    /// Counts those who share a home: "couple", "family of five", "two adults and three children".
    fn share_a_home(
        &mut self,
        tokens: &[Token],
        numbers: &[numbers::Number],
        mentions: &[Mention],
        spoken: &[&Spoken],
    ) {
        let tagged = |m: &&Mention, tag| spoken.iter().any(|s| s.tag_at(tokens, m.span.start, tag).is_some());
        let sum = |tag| {
            let all = mentions.iter().filter(|m| !matches!(m.what, What::Room(_))).filter(|m| tagged(m, tag));
            let counted = all.filter_map(|m| m.count).filter(|n| (1..=MAX_HEADS).contains(n)).sum::<i64>();
            u32::try_from(counted).ok().filter(|n| *n > 0)
        };
        let (adults, children) = (sum(Tag::Adults), sum(Tag::Children));
        // "a couple with one child": the singular is no number of visitors
        let one = |i: usize| {
            let inside = mentions.iter().any(|m| matches!(m.what, What::Room(_)) && m.span.contains(i));
            let article =
                i.checked_sub(1).is_some_and(|k| numbers.iter().any(|n| n.span.contains(k) && n.value == 1.0));
            article && !inside && spoken.iter().any(|s| s.tag_at(tokens, i, Tag::Children).is_some())
        };
        let children = children.or_else(|| (0..tokens.len()).any(one).then_some(1));
        if children.or(adults).is_some() {
            self.occupancy.visitors = None;
        }
        let household = dwelling::household(tokens, numbers, spoken, children);
        self.children = children.unwrap_or(0);
        self.pair = household.is_some_and(|n| n > 1) || self.children > 0;
        self.residents = adults.zip(children).map(|(a, c)| a + c).or(self.residents).or(adults).or(household);
    }
}

/// Gives a basement of which nothing is said the room that it has for things.
fn furnish_basement(storeys: &mut Storeys, wishes: &mut Wishes, domain: &Domain) {
    let kind = words().dwelling.basement.iter().find_map(|id| domain.room_type(id));
    let Some(kind) = kind.filter(|k| storeys.bare_basement && !wishes.forbidden.contains(&k.id)) else { return };
    storeys.wanted.push(Wanted { room_type: kind.id.clone(), count: 1, at: Where::Level(-1) });
    match wishes.wishes.iter_mut().find(|w| w.room_type == kind.id) {
        Some(wish) => wish.count += 1,
        None => wishes.wishes.push(Wish::one(&kind.id, &kind.label.to_lowercase())),
    }
}

/// Turns "habitaciones con baño" into guest rooms with bathrooms where the word alone means a public toilet, and "patient
/// rooms with a bathroom each" into rooms with en suites where the word alone means one that several share.
fn name_private_bathrooms(wishes: &mut Wishes, domain: &Domain, lives: bool) {
    // of a type that the domain has not it is one of its own too: "chambres avec douche"
    let shared = |id: &String| domain.room_type(id).is_none_or(|t| t.wet && t.access != Access::Host);
    let washes = |id: &String| [&words().dwelling.bathroom, &words().dwelling.shower].contains(&id);
    for pair in wishes.pairs.iter_mut().filter(|p| p.belongs && !lives && washes(&p.a)) {
        let mut own =
            domain.room_types.iter().filter(|t| t.wet && t.access == Access::Host && t.hosts.contains(&pair.b));
        let Some(own) = own.next().filter(|_| shared(&pair.a)) else { continue };
        let named = wishes.wishes.iter().any(|w| w.room_type == own.id);
        match wishes.wishes.iter().position(|w| w.room_type == pair.a) {
            Some(same) if named => {
                wishes.wishes.remove(same);
            }
            Some(wish) => wishes.wishes[wish].room_type.clone_from(&own.id),
            None => {}
        }
        pair.a.clone_from(&own.id);
    }
    let Some(bathroom) = domain.room_type(&words().dwelling.bathroom).filter(|t| t.access == Access::Host) else {
        return;
    };
    let public = |id: &str| domain.room_type(id).is_some_and(|t| t.access != Access::Host && t.zone == bathroom.zone);
    for pair in wishes.pairs.iter_mut().filter(|p| p.belongs && bathroom.hosts.contains(&p.b)) {
        let toilet = words().dwelling.toilets.contains(&pair.a);
        if !(toilet && public(&pair.a)) || wishes.wishes.iter().any(|w| w.room_type == bathroom.id) {
            continue;
        }
        if let Some(wish) = wishes.wishes.iter_mut().find(|w| w.room_type == pair.a) {
            wish.room_type.clone_from(&bathroom.id);
        }
        pair.a.clone_from(&bathroom.id);
    }
}

fn total_area(text: &Text, request: &Request, conflicts: &mut Vec<Note>) -> Option<f64> {
    let named = text.areas.iter().filter(|a| !wishes::is_room_area(text, a)).map(|a| a.value).next();
    let named = named.filter(|&area| {
        let sane = (5.0..=MAX_AREA_M2).contains(&area);
        if !sane {
            conflicts.push(note(
                "impossible_area",
                format!("an area of {area:.1} m2 was left out; 5 to {MAX_AREA_M2} m2 can be planned"),
            ));
        }
        sane
    });
    if let (Some(flag), Some(named)) = (request.area_m2, named)
        && (flag - named).abs() > 0.01
    {
        conflicts.push(note(
            "area_flag",
            format!("the prompt says {named:.1} m2, the request {flag:.1} m2; {flag:.1} m2 was used"),
        ));
    }
    // One third of a millimeter squared of noise from unit factors helps nobody.
    request.area_m2.or(named).map(|a| (a * 100.0).round() / 100.0)
}

/// Returns the number of rooms that the prompt gives the building by its name.
fn said_total(mentions: &[Mention]) -> Option<u32> {
    let said = mentions.iter().find(|m| m.what == What::Total && !m.article && !m.vague && m.count.is_some())?;
    u32::try_from(said.count?).ok().filter(|n| *n > 0)
}

fn total_rooms(
    request: &Request,
    mentions: &[Mention],
    wishes: &Wishes,
    conflicts: &mut Vec<Note>,
) -> Result<Option<u32>, Error> {
    let named = mentions.iter().filter(|m| m.what == What::Total && !m.article && !m.vague).find_map(|m| m.count);
    if let Some(n) = named.filter(|n| *n > MANY) {
        return Err(refused(format!(
            "the prompt asks for {n} rooms; one world has {MAX_ROOMS} at most, ask for fewer"
        )));
    }
    let named = named.filter(|&n| {
        if n <= 0 {
            conflicts
                .push(note("impossible_count", format!("{n} rooms cannot be built; the usual number was planned")));
        }
        n > 0
    });
    let named = named.and_then(|n| u32::try_from(n).ok());
    if let (Some(flag), Some(n)) = (request.rooms, named)
        && flag != n
    {
        conflicts.push(note("rooms_flag", format!("the prompt says {n} rooms, the request {flag}; {flag} was used")));
    }
    let total = request.rooms.or(named);
    let listed: u32 = wishes.wishes.iter().map(|w| w.count).fold(0, u32::saturating_add);
    if let Some(n) = total.filter(|n| *n < listed && listed <= MAX_ROOMS) {
        conflicts.push(note(
            "more_rooms_listed",
            format!("{n} rooms were asked for in total, but {listed} are listed; {listed} were planned"),
        ));
        return Ok(Some(listed));
    }
    Ok(total)
}

/// Returns true for programs of buildings that people live in.
pub(super) fn is_dwelling(program: &Program) -> bool {
    let d = &words().dwelling;
    let first = program.rooms.first().is_some_and(|r| r.room_type == d.studio);
    first || program.rooms.iter().any(|r| r.room_type == d.bedroom || r.room_type == d.living)
}

/// Returns true for rooms listed behind the name of a building and no colon: these are what it has, and perhaps not all.
/// Behind a colon too where rooms that nobody thinks of serve the others (`served`): an emergency department has its utilities;
/// but not where the prompt says how the rooms lie, for then it has them all in mind.
fn joins_a_name(building: &Building, tokens: &[Token], language: &str, served: bool) -> bool {
    let colon = !served && tokens.iter().any(|t| t.mark() == Some(':'));
    !colon && is_named_first(building, language)
}

/// Returns true for the name of a building before its rooms.
fn is_named_first(building: &Building, language: &str) -> bool {
    // where the name comes last, a list goes with it all the same
    building.head.is_some() && (building.list_from > 0 || matches!(language, "zh" | "ko"))
}

/// Types of rooms from which on a list is a long one: who names so many means no others.
const LONG_LIST: usize = 4;

/// Returns true when the listed rooms are the whole building.
fn is_closed(wishes: &Wishes, tokens: &[Token], building: &Building, (domain, lives): (&Domain, bool)) -> bool {
    if building.listed_type && building.list_from > 0 {
        return false;
    }
    let listed: Vec<_> = wishes.wishes.iter().filter(|w| w.listed).collect();
    let colon = tokens.get(building.list_from).is_some_and(|t| t.mark() == Some(':'));
    let types = listed.len();
    // how many toilets a long list has is no news about its other rooms
    let serves = |w: &Wish| domain.room_type(&w.room_type).is_some_and(|k| k.zone == Zone::Service);
    let long = !lives && types >= LONG_LIST;
    let open = listed.iter().any(|w| !(w.exact || long && serves(w)));
    // "no kitchen, no bathroom" in a list of rooms are items of it
    let items = types + wishes.forbidden.len();
    // "3BHK with a balcony", "four bedrooms and a garage": what every dwelling has goes without saying
    let settled = |id: &String| wishes.wishes.iter().any(|w| &w.room_type == id) || wishes.forbidden.contains(id);
    let whole = !lives || words().dwelling.essential.iter().all(|any| any.iter().any(settled));
    // "each bedroom has an en suite" leaves open how many there are
    let counted = |p: &PerHost| p.host.as_ref().is_none_or(|h| wishes.wishes.iter().any(|w| &w.room_type == h));
    let whole = whole && wishes.per_host.iter().all(counted);
    !open && whole && types >= 1 && (items >= 3 || types >= 2 && colon)
}

/// Returns true for "only three offices", "exactly 5 rooms", "nothing else": no room may be added.
fn says_only(tokens: &[Token], mentions: &[Mention], spoken: &[&Spoken]) -> bool {
    (0..tokens.len()).any(|i| {
        let Some(end) = spoken.iter().find_map(|s| s.tag_at(tokens, i, Tag::Only)) else { return false };
        let from = |m: &Mention| m.from.min(m.span.start);
        let next = mentions.iter().filter(|m| from(m) >= end).min_by_key(|m| from(m));
        let rooms = next.filter(|m| m.room_type().is_some() || m.what == What::Total);
        // "nothing else", but not "for staff only"
        let closes = end > i + 1 && tokens.get(end).is_none_or(Token::is_mark);
        closes || rooms.is_some_and(|m| from(m) <= end + 1)
    })
}

/// Adds to a list of rooms the one the building is for where the list takes it for granted: a laboratory's laboratory,
/// a supermarket's sales floor, the desks of those who work there, in shared offices where the layout is to be cellular. A
/// dwelling has no such room.
fn add_main_room(
    wishes: &mut Wishes,
    program: &Program,
    domain: &Domain,
    (people, desks_told): (&People, u32),
    named: Option<&str>,
    layout: Option<LayoutStyle>,
) -> Option<Note> {
    let heads = &people.occupancy;
    let workers = heads.staff.max(heads.desks);
    let left_out = workers::room_left_out(wishes, program, domain, workers, desks_told);
    let kind = left_out.or_else(|| main_room_left_out(wishes, program, domain, people, named))?;
    let ruled_out = wishes.forbidden.contains(&kind.id);
    let layout = if ruled_out { Some(LayoutStyle::Cellular) } else { layout };
    if let Some(people) = workers.filter(|_| layout == Some(LayoutStyle::Cellular))
        && let Some(seated) = workers::seat_in_listed(wishes, domain, people)
    {
        return Some(seated);
    }
    let laid_out = layout.zip(workers).and_then(|(l, n)| layout::in_place_of(domain, &kind.id, l, n));
    let (kind, count) = laid_out.or((!ruled_out).then_some((kind, 1)))?;
    let label = kind.label.to_lowercase();
    wishes.wishes.insert(0, Wish { count, ..Wish::one(&kind.id, &label) });
    Some(note("main_room", format!("the list of rooms takes the {label} for granted; it was added")))
}

/// Returns the room that a program begins with, where the list has nothing that could stand for it.
fn main_room_left_out<'a>(
    wishes: &Wishes,
    program: &Program,
    domain: &'a Domain,
    people: &People,
    named: Option<&str>,
) -> Option<&'a RoomType> {
    let main = program.rooms.first()?;
    let listed = |id: &str| wishes.wishes.iter().any(|w| w.room_type == id);
    // "a ward with 16 beds in double rooms" has no others
    let slept_in = main.occupants == Occupants::Beds && beds::names_rooms(domain, wishes);
    let ruled_out = wishes.forbidden.contains(&main.room_type);
    if is_dwelling(program) || slept_in || listed(&main.room_type) || ruled_out {
        return None;
    }
    let works = |r: &ProgramRoom| {
        let seat = r.area_per_occupant_m2.is_some() || r.occupants_per_room.is_some_and(|n| n <= MOST_IN_OFFICE);
        r.occupants == Occupants::Staff && seat
    };
    let team =
        |w: &Wish| domain.room_type(&w.room_type).and_then(|k| seated::desks(domain, k)).is_some_and(|d| d[1] > 2);
    let placed = domain.programs.iter().flat_map(|p| &p.rooms).any(|r| works(r) && listed(&r.room_type))
        || wishes.wishes.iter().any(team);
    let size = |id: &str| domain.room_type_or_generic(id).area_m2.target;
    let largest = wishes.wishes.iter().map(|w| size(&w.room_type)).fold(0.0, f64::max);
    let heads = people.occupancy.staff.or(people.occupancy.desks).is_some() && works(main);
    // desks elsewhere stand for the office of the staff, not for the hall of a warehouse
    let placed = placed && works(main);
    let needed = named == Some(main.room_type.as_str())
        || !placed && (heads || size(&main.room_type) > MAIN_ROOM_SHARE * largest);
    needed.then(|| domain.room_type_or_generic(&main.room_type))
}

/// Returns the words that wish for access, as in "wheelchair users": all but the things of lists, as in "with a bed, two
/// wheelchairs and a desk".
fn access_wishes(tokens: &[Token], numbers: &[numbers::Number], spoken: &[&Spoken]) -> Vec<Span> {
    let tagged = |i: usize, tag| spoken.iter().find_map(|s| s.tag_at(tokens, i, tag));
    let parted = |i: usize, tags: &[Tag]| {
        tokens.get(i).is_none_or(Token::is_mark) || tags.iter().any(|&t| tagged(i, t).is_some())
    };
    let listed = |i: usize| {
        let opens = |k: usize| [Tag::Starts, Tag::Joins].iter().any(|&t| tagged(k, t) == Some(i));
        i == 0 || tokens[i - 1].is_mark() || (i.saturating_sub(3)..i).any(opens)
    };
    let is_thing = |start: usize, end: usize| {
        let number = numbers.iter().find(|n| n.span.end == start);
        let before = number.map_or_else(|| listed(start), |n| !n.article || listed(n.span.start));
        before && parted(end, &[Tag::Joins, Tag::Stops])
    };
    (0..tokens.len())
        .filter_map(|start| tagged(start, Tag::Accessible).map(|end| Span { start, end }))
        .filter(|s| !is_thing(s.start, s.end))
        .collect()
}
