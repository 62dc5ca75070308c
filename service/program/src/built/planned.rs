//! A room of the building to be, before the graph states it.

use d3dgen_model::domain::RoomType;

/// A room to be.
#[derive(Debug, Clone)]
pub(crate) struct Planned<'a> {
    /// Type of the domain, or a name that only the prompt knows.
    pub room_type: String,
    /// What the domain knows about it.
    pub kind: &'a RoomType,
    /// The prompt's words for a type the domain does not know.
    pub name: Option<String>,
    /// Area the prompt gives, m^2.
    pub area_m2: Option<f64>,
    /// Lengths of its sides that the prompt gives, m.
    pub sides_m: Option<[f64; 2]>,
    /// Factor on its usual area that the prompt asks for.
    pub size: Option<f64>,
    /// Area that the people in it ask for, m^2.
    pub people_area_m2: Option<f64>,
    /// Area that the table of those who live there asks for, m^2: what a small home leaves others less for.
    pub table_area_m2: Option<f64>,
    /// Area that a proposal gives, m^2; within the range of its type.
    pub proposed_area_m2: Option<f64>,
    pub requested: bool,
    /// Index of the room it is entered from, when that is not the circulation.
    pub host: Option<usize>,
    /// People, beds or desks it is to hold.
    pub occupants: Option<u32>,
    /// Unit of a large building that it belongs to.
    pub unit: Option<String>,
    /// What the prompt calls it, where that is not the label of its type.
    pub called: Option<String>,
    /// True where its occupants only meet, wait or eat there.
    pub visited: bool,
}

impl<'a> Planned<'a> {
    /// Returns the area that it is reckoned with before it is sized, m^2: as asked for, else for its people, else the usual.
    pub(crate) fn reckoned_m2(&self) -> f64 {
        self.area_m2.or(self.people_area_m2).unwrap_or(self.kind.area_m2.target)
    }

    /// Sizes a room by the people it is for, within what its type allows; a size that the prompt gives stays.
    pub(super) fn size_for_people(&mut self, area_m2: f64) {
        let range = self.kind.area_m2;
        self.people_area_m2 = self.area_m2.is_none().then(|| area_m2.clamp(range.min, range.max));
    }

    /// Returns a room of a type that nobody said more about.
    pub(crate) fn new(room_type: &str, kind: &'a RoomType) -> Self {
        Self {
            room_type: room_type.to_owned(),
            kind,
            name: None,
            area_m2: None,
            sides_m: None,
            size: None,
            people_area_m2: None,
            table_area_m2: None,
            proposed_area_m2: None,
            requested: false,
            host: None,
            occupants: None,
            unit: None,
            called: None,
            visited: false,
        }
    }
}
