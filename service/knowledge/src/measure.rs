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
    /// Radius of the free half circle before the middle of an object's front, m.
    FreeHalfCircle,
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
    /// Docks whose back stands against a wall.
    DockAgainstWall,
    /// Docks that leave circulation its required width.
    DockKeepsEgress,
    /// Docks for each robot.
    DocksPerRobot,
    /// Width, depth and height of an object: the shorter plan side where the longer one suffices, m.
    ObjectSize,
    /// How far the extents of an object lie outside the given ones, m.
    ObjectExtents,
    /// Extent of an object across its front, m.
    ObjectWidth,
    /// Extent of an object front to back, m.
    ObjectDepth,
    /// Height of the top of an object above the floor, m.
    ObjectHeight,
    /// Free floor all around an object, m.
    ObjectAround,
    /// Free floor in front of an object and at both its sides, m.
    ObjectThreeSides,
    /// Distance from an object to the nearest wall around it that it does not stand against, m.
    ObjectToWall,
    /// Distance from an object to the nearest of other kinds, m.
    ObjectToObject,
    /// Distance from the middle of an object to what stands at its side, m.
    CentreToSide,
    /// Distance between the middles of objects of a kind, m.
    CentreSpacing,
    /// Free floor between desks or shelves that face each other, m.
    FacingGap,
    /// Edge of a table for each seat at it, m.
    TableEdgePerSeat,
    /// Distance from an object to the nearest window of its room, m.
    WindowDistance,
    /// How far things on walls stand out into circulation, m.
    WallProjection,
    /// Distances between sink, stove and refrigerator, m.
    WorkTriangleLeg,
    /// Sum of the distances between sink, stove and refrigerator, m.
    WorkTriangleTotal,
    /// Net floor area of a room for each object of a kind in it, m^2.
    AreaPerObject,
    /// Gross floor area of a room for each person in it, m^2.
    GrossAreaPerPerson,
    /// Net floor area beyond the first workplace's for each further one, m^2.
    AreaPerFurther,
    /// Floor without furniture for each person, m^2.
    FreeAreaPerPerson,
    /// People on 100 m^2 of a room.
    PersonsPer100,
    /// Net floor area of the largest room of a kind, m^2.
    LargestRoomArea,
    /// Net floor area of the building for each person, m^2.
    BuildingAreaPerPerson,
    /// Net floor area of the building for each desk, m^2.
    BuildingAreaPerWorkplace,
    /// Gross floor area of the building for each bed, m^2.
    BuildingAreaPerBed,
    /// People for each room of a kind.
    PersonsPerRoom,
    /// Beds for each room of a kind.
    BedsPerRoomKind,
    /// People for each object of a kind.
    PersonsPerObject,
    /// People in a building with one exit.
    PersonsBySingleExit,
    /// Width of all exits for each person, in the constraint's unit.
    ExitWidthPerPerson,
    /// Circulation over the net floor area of all other rooms.
    CirculationAllowance,
    /// Way from the farthest free point of a room to circulation, m.
    DistanceToCirculation,
    /// Largest width of a window of a room, m.
    WindowWidth,
    /// Largest height of a window of a room, m.
    WindowHeight,
    /// Area of the largest window of a room, m^2.
    WindowArea,
    /// Depth of a room behind its windows over its height.
    DepthToHeight,
    /// Free floor inside a door, m.
    DoorLanding,
    /// Free floor before a door on the side it opens to, m.
    DoorPullDepth,
    /// Free floor before a door on the side it opens from, m.
    DoorPushDepth,
    /// Wall beside the latch of a door on the side it opens to, m.
    LatchPullSide,
    /// Wall beside the latch of a door on the side it opens from, m.
    LatchPushSide,
    /// No wall joins two kinds of rooms.
    NoSharedWall,
    /// Radius of robots of a kind, m.
    RobotRadius,
    /// Number of exits.
    Exits,
    /// Desks of the building for so much floor of the rooms, the area being the row's base.
    DesksPerArea,
    /// Docks in the room of the main entrance or next to it.
    DockNearEntrance,
    /// A wall joins each room of one kind with one of the other.
    SharedWall,
    /// Time to walk from the farthest room to the nearest of a kind, min.
    WalkingMinutes,
    /// Free width under a desk, m.
    LegRoom,
    /// Height of the threshold of a door, m.
    Threshold,
    /// Circulation without stairs, apart from stairwells beside an elevator.
    NoStairs,
    /// Clear width of a flight of stairs, m.
    FlightWidth,
    /// Rise of a step, m.
    StepRise,
    /// Going of a step, m.
    StepGoing,
    /// Pitch of stairs, degrees.
    StairsPitch,
    /// Circulation without glass down to the floor and without mirrors.
    NoGlassOrMirrors,
    /// Distance between robots where they start, m.
    RobotsApart,
    /// Walking speed of people, m/s.
    WalkingSpeed,
    /// Free width at each side of the widest robot in the middle of circulation, m.
    SideClearance,
    /// Width of circulation beyond that of the widest robot, m.
    SpareWidth,
    /// Length of a corridor beyond its last way out, in buildings with two exits, m.
    DeadEnd,
    /// Way to the first room from which two ways lead out that have no room in common, or to the only exit, m.
    CommonPath,
    /// Longest way to an exit over the straight line between its ends; at least 1.
    WalkingFactor,
    /// Height of the middle of a thing on a wall, m.
    MountHeight,
    /// Height of the underside of a thing on a wall, which hands reach for, m.
    UndersideHeight,
    /// Clear height that a share of the net floor area has, the share being the row's base, m.
    CeilingOfMost,
    /// Distance from the middle of a thing on a wall to the nearest corner of the room beside it, m.
    CornerDistance,
    /// Distance from an object to the nearest door to a room of other kinds, m.
    ObjectToDoor,
    /// Worktop beside an appliance, at the side with less of it, m.
    LandingShorter,
    /// Worktop beside an appliance, at the side with more of it, m.
    LandingLonger,
    /// Length by which something stands in a line between sink, stove and refrigerator, m.
    TriangleIntrusion,
    /// The way between the doors of a kitchen passes by the triangle of sink, stove and refrigerator.
    TriangleClearOfTraffic,
    /// Free floor behind the edges of a table that people sit at, m.
    SeatedDepth,
    /// Edge of a table for each seat at it, where the table is deep enough for knees, m.
    SeatSpace,
    /// A rectangle of free floor at the front of an object, in either direction, m.
    ClearFloorAtObject,
    /// Width of the free floor in front of an object that is as deep as the constraint asks, m.
    ClearInFront,
    /// Width of the floor around an object that is as deep from the wall behind as the constraint asks, m.
    ClearanceAround,
    /// Clear extent of the widest room of a kind, m.
    LargestDimension,
    /// Number of rooms of a kind that the conditions leave.
    RoomsCounted,
    /// Number of rooms of one kind with one of another for themselves.
    EnsuiteRooms,
    /// Every room has a way out that passes through no room of a kind.
    ReachesExitWithout,
    /// Net floor area of all rooms of a kind together, m^2.
    RoomKindArea,
    /// Sides of an object that a person can stand at.
    AccessibleSides,
    /// Distance from the head of a bed to the nearest window of its room, m.
    HeadToWindow,
    /// Number of beds of the building.
    BedsInBuilding,
    /// Doors whose leaf opens out of the room.
    OpensOutward,
    /// Gross floor area of the building for each robot of a kind, m^2.
    BuildingAreaPerRobot,
    /// Distance from a dock to the farthest floor to be cleaned, m.
    DockReach,
    /// Distance from the side of a bed to the wall that no other bed stands before, m.
    BedToSideWall,
    /// Free floor at the narrower side of a bed, where the other side has what it needs, m.
    BedSidePair,
    /// Gross floor area of the building, m^2.
    GrossBuildingArea,
    /// Floor without steps.
    FloorStep,
    /// Slope of the floor, degrees.
    FloorSlope,
    /// A floor without steps and slopes.
    FloorFlat,
    /// Net floor area of all rooms of a kind for each bed of the building, m^2.
    KindAreaPerBed,
    /// Area of the windows of a room over its net floor area, of which a part opens.
    OpenableRatio,
    /// Somebody at work in a room sees a bed, or the door of a room with one, within 20 m.
    SeesBeds,
}

impl Measure {
    /// Returns true when advice with a bare figure means "no more than" rather than "no less than".
    pub(crate) fn advice_is_maximum(self) -> bool {
        matches!(
            self,
            Self::Proportion
                | Self::WindowSill
                | Self::TravelDistance
                | Self::CommonPath
                | Self::DeadEnd
                | Self::WalkingFactor
                | Self::StraightDistance
                | Self::DistanceToRoom
                | Self::DistanceBetween
                | Self::BedsPerRoom
                | Self::PersonsPerToilet
                | Self::BedsPerToilet
                | Self::CirculationShare
                | Self::CirculationAllowance
                | Self::PersonsPerRoom
                | Self::DesksPerArea
                | Self::WalkingMinutes
                | Self::Threshold
                | Self::BedsPerRoomKind
                | Self::PersonsPerObject
                | Self::PersonsPer100
                | Self::RobotRadius
                | Self::WalkingSpeed
        )
    }

    /// Returns true when more than the upper end of an advised range does no harm.
    pub(crate) fn is_clearance(self) -> bool {
        use Measure as M;
        matches!(self, M::ObjectFront | M::FreeHalfCircle | M::AreaPerPerson)
            || matches!(self, M::ObjectSides | M::ObjectAround | M::ObjectThreeSides | M::ObjectToWall | M::FacingGap)
            || matches!(self, M::GapBetweenObjects | M::TableEdgePerSeat | M::ClearFloorAtObject | M::SeatedDepth)
    }

    /// Returns true for an extent of an object, which advice gives as the usual figure.
    pub(crate) fn is_extent(self) -> bool {
        matches!(self, Self::ObjectWidth | Self::ObjectDepth | Self::ObjectHeight | Self::MountHeight)
    }

    /// Returns true for figures by the number of people who use a building, which its area does not tell.
    ///
    /// Ways out are another matter: building codes reckon the people on them from the area.
    pub(crate) fn is_by_users(self) -> bool {
        use Measure as M;
        matches!(self, M::ToiletsForPersons | M::PersonsPerToilet | M::PersonsPerObject | M::PersonsPerRoom)
            || matches!(self, M::RoomNeededAbovePersons | M::BuildingAreaPerPerson)
    }
}
