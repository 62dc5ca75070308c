//! What domains lend each other: a meeting room is furnished alike in a hotel that has none of its own.

use std::collections::BTreeMap;

use super::{Access, Domain, GENERIC_ROOM_TYPE, Group, ObjectType, RoomType};

/// Room types that a domain does not know itself, with the objects and groups that stand in them.
///
/// They are no part of the domain's document, have no words that a prompt is read by, and join no program: rooms of such a type
/// are there because somebody asked for them by this type.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lent {
    /// By id, each with the id of the domain that lends it.
    room_types: BTreeMap<String, (String, RoomType)>,
    objects: BTreeMap<String, ObjectType>,
    groups: BTreeMap<String, Group>,
}

impl Lent {
    /// Returns what `others` lend to `domain`: all that it has no own of that id, from the first that has it.
    pub fn to<'a>(domain: &Domain, others: impl IntoIterator<Item = &'a Domain>) -> Self {
        let mut lent = Self::default();
        for other in others.into_iter().filter(|o| o.id != domain.id) {
            let new = |id: &str| domain.room_type(id).is_none() && id != GENERIC_ROOM_TYPE;
            for kind in other.room_types.iter().filter(|k| new(&k.id)) {
                let entry = || (other.id.clone(), for_others(kind));
                lent.room_types.entry(kind.id.clone()).or_insert_with(entry);
            }
            for object in &other.objects {
                lent.objects.entry(object.id.clone()).or_insert_with(|| plainly_built(object, other));
            }
            for group in &other.groups {
                lent.groups.entry(group.id.clone()).or_insert_with(|| group.clone());
            }
        }
        lent
    }

    /// Returns the room type with this id and the id of the domain that lends it.
    pub fn room_type(&self, id: &str) -> Option<(&str, &RoomType)> {
        self.room_types.get(id).map(|(lender, kind)| (lender.as_str(), kind))
    }

    /// Returns all room types that are lent.
    pub fn room_types(&self) -> impl Iterator<Item = &RoomType> {
        self.room_types.values().map(|(_, kind)| kind)
    }

    /// Returns the object type with this id.
    pub fn object(&self, id: &str) -> Option<&ObjectType> {
        self.objects.get(id)
    }

    /// Returns all object types that are lent.
    pub fn objects(&self) -> impl Iterator<Item = &ObjectType> {
        self.objects.values()
    }

    /// Returns the group with this id.
    pub fn group(&self, id: &str) -> Option<&Group> {
        self.groups.get(id)
    }
}

/// Returns a room type as it is elsewhere: the rooms through which one enters it at home need not be there.
fn for_others(kind: &RoomType) -> RoomType {
    RoomType { access: Access::Circulation, hosts: Vec::new(), ..kind.clone() }
}

/// Returns an object type without the build that only its own domain brings: its shape stands for that.
fn plainly_built(object: &ObjectType, of: &Domain) -> ObjectType {
    let shipped = |build: &String| !of.builds.iter().any(|own| &own.id == build);
    ObjectType { build: object.build.clone().filter(shipped), ..object.clone() }
}
