//! Colors, line weights and type sizes of the plan.

use d3dgen_model::domain::Zone;
use d3dgen_model::scenario::RoiKind;

use super::page::Type;
use crate::font::Weight;

/// Color of type and walls.
pub(super) const INK: &str = "#2b2e34";
/// Color of secondary type.
pub(super) const GRAY: &str = "#6a6f78";
/// Color of frames and rules.
pub(super) const RULE: &str = "#b9bcc2";
/// Color of robot things.
pub(super) const ROBOT: &str = "#1f6fb2";
/// Color of docks.
pub(super) const CHARGE: &str = "#2e8b57";

/// Names of rooms.
pub(super) const NAME: Type = Type { weight: Weight::SemiBold, fill: INK, halo: Some("#ffffff") };
/// Areas of rooms.
pub(super) const AREA: Type = Type { weight: Weight::Regular, fill: "#4d525b", halo: Some("#ffffff") };
/// Headings of the title block.
pub(super) const HEADING: Type = Type { weight: Weight::SemiBold, fill: INK, halo: None };
/// Running text of the title block.
pub(super) const TEXT: Type = Type { weight: Weight::Regular, fill: INK, halo: None };
/// Labels and remarks.
pub(super) const SMALL: Type = Type { weight: Weight::Regular, fill: GRAY, halo: None };

/// Returns the floor tint of a part of the building.
pub(super) fn tint(zone: Zone) -> &'static str {
    match zone {
        Zone::Day => "#fbf3e2",
        Zone::Night => "#e9eff8",
        Zone::Public => "#fdeedd",
        Zone::Staff => "#e9f3e6",
        Zone::Service => "#e4f1f1",
        Zone::Circulation => "#f5f4f1",
        Zone::Outdoor => "#edf3df",
    }
}

/// Returns fill and stroke of a robot zone.
pub(super) fn roi_colors(kind: RoiKind) -> (&'static str, &'static str) {
    match kind {
        RoiKind::CleaningZone => ("#6fa8d6", "#6fa8d6"),
        RoiKind::ServiceZone => ("#f0a04b", "#d9822b"),
        RoiKind::ChargingBuffer => ("#58b37e", "#2e8b57"),
        RoiKind::KeepOut => ("#d9604f", "#c9503f"),
        RoiKind::SpeedZone => ("#8a6fc0", "#8a6fc0"),
        RoiKind::StagingArea => ("#b08a4a", "#8f6d34"),
    }
}

/// Returns the legend's words for a robot zone.
pub(super) fn roi_label(kind: RoiKind) -> &'static str {
    match kind {
        RoiKind::CleaningZone => "Cleaning zone",
        RoiKind::ServiceZone => "Service zone",
        RoiKind::ChargingBuffer => "Charging buffer",
        RoiKind::KeepOut => "Robots keep out",
        RoiKind::SpeedZone => "Robots drive slowly",
        RoiKind::StagingArea => "Staging area",
    }
}

/// Returns the style sheet; `k` scales line weights with the drawing's scale.
///
/// Classes: `b` body, `s` soft inlay, `f` fine line, `h` hidden (above the cut), `d` dark, `wa` water, `p` plant, `r` rug, `w` wall.
pub(super) fn sheet(k: f64) -> String {
    let w = |v: f64| format!("{:.2}", v * k);
    [
        "path{stroke-linejoin:round;stroke-linecap:round}".to_owned(),
        format!(".b{{fill:#fff;stroke:#5a5f68;stroke-width:{}}}", w(1.25)),
        format!(".s{{fill:#f3f2ee;stroke:#8e939b;stroke-width:{}}}", w(0.9)),
        format!(".f{{fill:none;stroke:#8e939b;stroke-width:{}}}", w(0.9)),
        format!(".h{{fill:none;stroke:#a9adb4;stroke-width:{};stroke-dasharray:{} {}}}", w(0.9), w(5.0), w(4.0)),
        ".d{fill:#5a5f68}".to_owned(),
        format!(".wa{{fill:#cfe8f5;stroke:#6aa7c8;stroke-width:{}}}", w(0.9)),
        format!(".p{{fill:#d9e8cd;stroke:#6f9463;stroke-width:{}}}", w(0.9)),
        format!(".pf{{fill:none;stroke:#6f9463;stroke-width:{}}}", w(0.8)),
        format!(".r{{fill:#fffdf8;fill-opacity:.75;stroke:#cfc4b2;stroke-width:{}}}", w(0.9)),
        format!(".g{{fill:#d5eddf;stroke:{CHARGE};stroke-width:{}}}", w(1.2)),
        format!(".gd{{fill:{CHARGE}}}"),
        format!(".wo{{fill:none;stroke:#1f2126;stroke-width:{};stroke-linejoin:miter}}", w(2.2)),
        ".w{fill:#3c4048}".to_owned(),
        format!(".rl{{fill:#8e939b;stroke:#5a5f68;stroke-width:{}}}", w(0.6)),
        format!(".n{{fill:#fff;stroke:#1f2126;stroke-width:{}}}", w(1.2)),
        format!(".nf{{fill:none;stroke:#1f2126;stroke-width:{}}}", w(0.9)),
        format!(".dl{{fill:#fff;stroke:{INK};stroke-width:{}}}", w(1.3)),
        ".dp{fill:#a9adb4}".to_owned(),
        format!(".dx{{fill:{ROBOT};stroke:{ROBOT};stroke-width:{}}}", w(0.9)),
        format!(".da{{fill:none;stroke:#7d828b;stroke-width:{}}}", w(1.0)),
        format!(".do{{fill:none;stroke:#7d828b;stroke-width:{};stroke-dasharray:{} {}}}", w(1.1), w(6.0), w(5.0)),
        format!(".dm{{fill:none;stroke:#9a9ea6;stroke-width:{}}}", w(0.9)),
        format!(".dt{{fill:none;stroke:#5a5f68;stroke-width:{}}}", w(1.6)),
        format!(".ea{{fill:{INK}}}"),
        format!(".ex{{fill:#fff;stroke:{INK};stroke-width:{}}}", w(1.2)),
        format!(".ro{{fill:#fff;stroke:{ROBOT};stroke-width:{}}}", w(1.6)),
        format!(".rs{{fill:{ROBOT};fill-opacity:.18;stroke:{ROBOT};stroke-width:{}}}", w(1.6)),
        format!(".rd{{fill:{ROBOT}}}"),
        format!(".ck{{fill:{CHARGE}}}"),
        ".wt{fill:#fff}".to_owned(),
        format!(".kn{{fill:#fff;stroke:{INK};stroke-width:{}}}", w(1.2)),
        format!(".sb{{fill:{INK};stroke:{INK};stroke-width:1}}"),
        format!(".sw{{fill:#fff;stroke:{INK};stroke-width:1}}"),
        format!(".nr{{fill:none;stroke:{GRAY};stroke-width:1}}"),
        format!(".fr{{fill:none;stroke:{RULE};stroke-width:1}}"),
    ]
    .join("")
}
