//! Nodes of a cubature rule on a disk, in groups for vector instructions.

use glam::DVec3;

/// Number of nodes of a group.
pub const LANES: usize = 4;

/// Some nodes of a rule: coordinates in the plane of the disk, scene units, and areas. Nodes that
/// fill up the last group have no area.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskNodeGroup {
    /// Along the first axis of the plane.
    pub x: [f64; LANES],
    /// Along the second one.
    pub y: [f64; LANES],
    /// Area for which a node stands.
    pub area: [f64; LANES],
}

/// The nodes of a rule.
#[derive(Clone, Debug, Default)]
pub struct DiskNodes {
    groups: Vec<DiskNodeGroup>,
    count: usize,
}

/// Where a disk is, as seen from a point.
#[derive(Clone, Copy, Debug)]
pub struct DiskFrame {
    /// From the point to the centre, scene units.
    pub center: DVec3,
    /// Unit vectors in the plane.
    pub axes: [DVec3; 2],
    /// Unit normal of the side that emits.
    pub normal: DVec3,
    /// Scene units.
    pub radius: f64,
}

impl DiskNodes {
    /// The groups of all nodes.
    #[must_use]
    pub fn groups(&self) -> &[DiskNodeGroup] {
        &self.groups
    }

    /// Removes all nodes.
    pub fn clear(&mut self) {
        self.groups.clear();
        self.count = 0;
    }

    /// Adds a node.
    #[inline]
    pub fn push(&mut self, x: f64, y: f64, area: f64) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.groups.push(DiskNodeGroup::default());
        }
        if let Some(group) = self.groups.last_mut() {
            (group.x[lane], group.y[lane], group.area[lane]) = (x, y, area);
        }
        self.count += 1;
    }
}
