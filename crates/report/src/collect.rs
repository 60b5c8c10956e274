//! Which series there are: the quantities of the plots, found among the channels.

use crate::lookup::Lookup;
use crate::sites::SiteGraph;
use anergy_core::recorder::ChannelGroup;
use anergy_core::recorder::ChannelGroup::{Edges, Interfaces, Nodes, Units};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// A series with its values.
pub struct Source<'a> {
    /// Name in the legend.
    pub name: String,
    /// Place: curves of one place have one colour.
    pub key: String,
    /// Its values, SI.
    pub column: Cow<'a, [f64]>,
}

/// Finds the series of the plots.
pub struct Collector<'a, 'b> {
    /// The recording.
    pub lookup: &'b Lookup<'a>,
    /// The places.
    pub sites: &'b SiteGraph,
}

impl<'a> Collector<'a, '_> {
    fn source(&self, component: &str, quantity: &str, name: String) -> Option<Source<'a>> {
        let column = Cow::Borrowed(self.lookup.column(component, quantity)?);
        Some(Source { name, key: self.sites.place_of(component).to_owned(), column })
    }

    /// Interfaces with their requests; without interfaces pumps, and without those all edges.
    pub fn flows(&self) -> (Vec<Source<'a>>, &'static str) {
        const FLOW: &str = "m_flow_kg_s";
        const REQUEST: &str = "requested_m_flow_kg_s";
        let mut sources = Vec::new();
        for component in self.lookup.components(Interfaces, FLOW) {
            sources.extend(self.source(component, FLOW, component.to_owned()));
            sources.extend(self.source(component, REQUEST, format!("{component} requested")));
        }
        if !sources.is_empty() {
            return (sources, "Stations: positive feeds in (cold to hot), negative extracts.");
        }
        let edges = &self.lookup.recording.header.map.edges;
        let flow = |id: &str| self.source(id, FLOW, id.to_owned());
        let pumps = edges.iter().filter(|edge| edge.kind.contains("pump"));
        let pumps: Vec<Source> = pumps.filter_map(|edge| flow(&edge.id)).collect();
        if !pumps.is_empty() {
            return (pumps, "Pumps: positive in the direction of the pump.");
        }
        let all = self.lookup.components(Edges, FLOW).filter_map(flow).collect();
        (all, "Edges: positive from port a to port b.")
    }

    /// A quantity of the nodes on the map: hot and cold nodes of sites, and plain nodes.
    pub fn outer_nodes(&self, quantity: &str) -> Vec<Source<'a>> {
        let nodes = &self.lookup.recording.header.map.nodes;
        let outer = self.sites.vertices.iter().flat_map(|vertex| [vertex.hot, vertex.cold]);
        let ids = outer.flatten().filter_map(|index| nodes.get(index)).map(|node| &node.id);
        let mut sources: Vec<Source> =
            ids.filter_map(|id| self.source(id, quantity, id.clone())).collect();
        if sources.is_empty() {
            let all = self.lookup.components(Nodes, quantity);
            sources = all.filter_map(|id| self.source(id, quantity, id.to_owned())).collect();
        }
        sources
    }

    /// Pressure of the hot node minus that of the cold node: of sites with station, or else of all.
    pub fn differences(&self) -> Vec<Source<'a>> {
        let nodes = &self.lookup.recording.header.map.nodes;
        let column = |node: Option<usize>| self.lookup.column(&nodes.get(node?)?.id, "p_pa");
        let difference = |vertex: &crate::sites::Vertex| {
            let (hot, cold) = (column(vertex.hot)?, column(vertex.cold)?);
            let column = hot.iter().zip(cold).map(|(hot, cold)| hot - cold).collect();
            let key = vertex.name.clone();
            Some(Source { name: key.clone(), key, column: Cow::Owned(column) })
        };
        let vertices = &self.sites.vertices;
        let any = vertices.iter().any(|vertex| !vertex.stations.is_empty());
        let wanted = vertices.iter().filter(|vertex| !any || !vertex.stations.is_empty());
        wanted.filter_map(difference).collect()
    }

    /// Rooms, and bottom and top of storages.
    pub fn houses(&self) -> Vec<Source<'a>> {
        let rooms = self.lookup.components(Units, "t_room_k");
        let mut sources: Vec<Source> =
            rooms.filter_map(|id| self.source(id, "t_room_k", id.to_owned())).collect();
        for id in self.lookup.components(Units, "t_1_k") {
            let layer = |layer: &usize| self.lookup.column(id, &format!("t_{layer}_k")).is_some();
            let top = (1..).take_while(layer).last().unwrap_or(1);
            sources.extend(self.source(id, "t_1_k", format!("{id} bottom")));
            sources.extend(self.source(id, &format!("t_{top}_k"), format!("{id} top")));
        }
        sources
    }

    /// A quantity of the stations.
    pub fn stations(&self, quantity: &str) -> Vec<Source<'a>> {
        self.all(Interfaces, quantity)
    }

    /// A quantity of the units.
    pub fn units(&self, quantity: &str) -> Vec<Source<'a>> {
        self.all(Units, quantity)
    }

    /// Heat of the units; that of their ports where they do not count it as a whole.
    pub fn unit_heat(&self) -> Vec<Source<'a>> {
        let mut sources = self.units("q_flow_w");
        let units: BTreeSet<String> = sources.iter().map(|source| source.name.clone()).collect();
        let whole =
            |name: &str| name.rsplit_once('.').is_some_and(|(unit, _)| units.contains(unit));
        sources.retain(|source| !whole(&source.name));
        sources.extend(self.named(Units, "emitted_w", "rooms"));
        sources
    }

    /// Electricity of units, of rods in storages, of pumps.
    pub fn electricity(&self) -> Vec<Source<'a>> {
        let mut sources = self.units("electric_w");
        sources.extend(self.named(Units, "rod_w", "rod"));
        sources.extend(self.all(Edges, "power_w"));
        sources
    }

    fn all(&self, group: ChannelGroup, quantity: &str) -> Vec<Source<'a>> {
        let all = self.lookup.components(group, quantity);
        all.filter_map(|id| self.source(id, quantity, id.to_owned())).collect()
    }

    fn named(&self, group: ChannelGroup, quantity: &str, word: &str) -> Vec<Source<'a>> {
        let all = self.lookup.components(group, quantity);
        all.filter_map(|id| self.source(id, quantity, format!("{id} {word}"))).collect()
    }

    /// A quantity of the edges.
    pub fn edges(&self, quantity: &str) -> Vec<Source<'a>> {
        self.all(Edges, quantity)
    }
}
