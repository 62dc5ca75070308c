//! The quantities of a world that constraints limit, and which way each limit goes.

use serde::Deserialize;

/// Something about a world that can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Net floor area of a room, m^2.
    RoomArea,
    /// Net floor area of all rooms, m^2.
    BuildingArea,
    /// Net floor area of a room for each bed in it, m^2.
    AreaPerBed,
    /// Net floor area of a room for each workplace or seat in it, m^2.
    AreaPerPerson,
    /// Floor area of the charging room for each robot, m^2.
    AreaPerRobot,
    /// Volume of a room for each workplace in it, m^3.
    AirVolumePerPerson,
    /// Least clear extent of a room, m.
    LeastDimension,
    /// A rectangle that fits between the walls of a room, m.
    InnerRectangle,
    /// A rectangle that fits on the free floor of a room, m.
    FreeRectangle,
    /// Diameter of a circle on the free floor of a room, m.
    TurningCircle,
    /// Length over width of a room.
    Proportion,
    /// Clear height of a room, m.
    CeilingHeight,
    /// Clear width of a door, m.
    DoorWidth,
    /// Width of the structural opening of a door, m.
    DoorOpeningWidth,
    /// Clear height of a door, m.
    DoorHeight,
    /// Doors whose leaf opens into circulation.
    SwingIntoCirculation,
    /// Height of a window sill, m.
    WindowSill,
    /// Window area over net floor area.
    WindowRatio,
    /// Number of windows of a room.
    Windows,
    /// Clear width of circulation with what stands in it, m.
    CirculationWidth,
    /// Circulation over all net floor area.
    CirculationShare,
    /// Way from the farthest free point to the nearest exit, m.
    TravelDistance,
    /// Straight line from the farthest free point to the nearest exit, m.
    StraightDistance,
    /// Way from the farthest room to the nearest room of a kind, m.
    DistanceToRoom,
    /// Way from each room of one kind to the nearest of another, m.
    DistanceBetween,
    /// Number of rooms.
    RoomsPresent,
    /// A room that more than so many people need.
    RoomNeededAbovePersons,
    /// Beds in a room.
    BedsPerRoom,
    /// Water closets by head count.
    ToiletsForPersons,
    /// People for each water closet.
    PersonsPerToilet,
    /// Beds for each water closet.
    BedsPerToilet,
    /// No door joins two kinds of rooms.
    NoDoorBetween,
    /// A door joins each room of one kind with one of the other.
    RoomsAdjacent,
    /// Free floor in front of an object, m.
    ObjectFront,
    /// Free floor at both sides of an object, m.
    ObjectSides,
    /// Free floor between objects of a kind, m.
    GapBetweenObjects,
    /// Free area in front of an object, m^2.
    FreeAreaAtObject,
    /// Docks outside the swing and lane of doors.
    DockClearOfDoors,
    /// Docks in rooms without plumbing.
    DockInDryRoom,
}

impl Measure {
    /// Returns true when advice with a bare figure means "no more than" rather than "no less than".
    pub(crate) fn advice_is_maximum(self) -> bool {
        matches!(
            self,
            Self::Proportion
                | Self::WindowSill
                | Self::TravelDistance
                | Self::StraightDistance
                | Self::DistanceToRoom
                | Self::DistanceBetween
                | Self::BedsPerRoom
                | Self::PersonsPerToilet
                | Self::BedsPerToilet
                | Self::CirculationShare
        )
    }
}
