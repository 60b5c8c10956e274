//! Reading and writing a simulation from outside: signals, channels, snapshots.

use super::Simulation;
use crate::channels::{self, Moment};
use crate::error::RunError;
use crate::state::State;
use anergy_core::ids::{ChannelId, SignalId};
use anergy_network::state::NetworkState;

impl Simulation {
    /// The id of an input signal.
    ///
    /// # Errors
    /// [`RunError::UnknownName`] with similar names.
    pub fn signal(&self, name: &str) -> Result<SignalId, RunError> {
        self.plan.signals.find(name).ok_or_else(|| {
            unknown("signal", name, self.plan.signals.specs().iter().map(|spec| spec.name.as_str()))
        })
    }

    /// Sets an input signal (SI) and takes it over from schedules and controllers.
    ///
    /// # Errors
    /// [`RunError::OutOfRange`] for values that the signal cannot have.
    pub fn set(&mut self, id: SignalId, value: f64) -> Result<(), RunError> {
        let spec = self.plan.signals.spec(id);
        if !(spec.min..=spec.max).contains(&value) {
            return Err(RunError::OutOfRange {
                signal: spec.name.to_string(),
                value,
                min: spec.min,
                max: spec.max,
            });
        }
        if self.state.signals[id.index()] != value {
            self.state.stepping.forget();
        }
        self.state.signals[id.index()] = value;
        self.state.taken_over[id.index()] = true;
        self.overrule_user(id, true);
        Ok(())
    }

    /// Gives a signal back to its schedule or controller; to that of the user, where there is one.
    pub fn release(&mut self, id: SignalId) {
        if !self.overrule_user(id, false) {
            self.state.taken_over[id.index()] = false;
        }
        self.state.stepping.forget();
    }

    /// Pressures, flows, temperatures and positions at present.
    pub fn network_state(&self) -> &NetworkState {
        &self.state.network
    }

    /// The id of a channel.
    ///
    /// # Errors
    /// [`RunError::UnknownName`] with similar names.
    pub fn channel(&self, name: &str) -> Result<ChannelId, RunError> {
        let names = || self.plan.channels().iter().map(|channel| channel.name.as_str());
        let index = names().position(|channel| channel == name);
        index.map(ChannelId::from_index).ok_or_else(|| unknown("channel", name, names()))
    }

    /// When within a step a channel has its value.
    pub fn moment(&self, id: ChannelId) -> Moment {
        channels::moment(&self.plan, self.plan.sources()[id.index()])
    }

    /// The present value of a channel, SI.
    pub fn get(&self, id: ChannelId) -> f64 {
        channels::value(&self.plan, &self.state, self.plan.sources()[id.index()])
    }

    /// Writes the present values of all channels.
    pub fn fill_row(&self, row: &mut [f64]) {
        for (value, source) in row.iter_mut().zip(self.plan.sources()) {
            *value = channels::value(&self.plan, &self.state, *source);
        }
    }

    /// The state as a snapshot. What controllers of the user remember is theirs to keep.
    pub fn snapshot(&self) -> State {
        self.state.clone()
    }

    /// Continues from a snapshot, bit for bit.
    ///
    /// # Errors
    /// [`RunError::Snapshot`] when it belongs to another model.
    pub fn restore(&mut self, snapshot: &State) -> Result<(), RunError> {
        let (own, other) = (&self.state, snapshot);
        let fits = own.signals.len() == other.signals.len()
            && own.network.m_flow_kg_s.len() == other.network.m_flow_kg_s.len()
            && own.network.p_pa.len() == other.network.p_pa.len()
            && own.network.requests.len() == other.network.requests.len()
            && own.network.parcels.fits(&other.network.parcels)
            && own.network.cells.fits(&other.network.cells)
            && own.unit_states.len() == other.unit_states.len()
            && own.controller_states.len() == other.controller_states.len()
            && own.swings.len() == other.swings.len()
            && own.sensors.len() == other.sensors.len()
            && own.sensors.iter().zip(&other.sensors).all(|(own, other)| own.fits(other))
            && own.network.density_kg_m3.len() == other.network.density_kg_m3.len()
            && own.unit_flags.len() == other.unit_flags.len()
            && own.stations.len() == other.stations.len()
            && own.meters.len() == other.meters.len()
            && own.kpis.fits(&other.kpis)
            && own.network.prescribed.len() == other.network.prescribed.len()
            && own.network.regulated.len() == other.network.regulated.len()
            && own.pulse_shares.len() == other.pulse_shares.len()
            && own.vessels.len() == other.vessels.len()
            && own.missed.len() == other.missed.len()
            && own.crossed.len() == other.crossed.len()
            && own.stepping.fits(&other.stepping);
        if (own.user_ticks.len(), own.user_overruled.len())
            != (other.user_ticks.len(), other.user_overruled.len())
        {
            let (own, other) = (own.user_ticks.len(), other.user_ticks.len());
            let problem = format!("it has {other} controllers of the user, the simulation {own}");
            return Err(RunError::Snapshot { problem });
        }
        if !fits {
            return Err(RunError::Snapshot { problem: "it is of another model".into() });
        }
        self.state.clone_from(snapshot);
        self.events.clear();
        Ok(())
    }

    /// Continues from the bytes of a snapshot.
    ///
    /// # Errors
    /// [`RunError::Snapshot`] when the bytes are torn or of another model.
    pub fn restore_bytes(&mut self, bytes: &[u8]) -> Result<(), RunError> {
        let state: State = postcard::from_bytes(bytes)
            .map_err(|error| RunError::Snapshot { problem: error.to_string() })?;
        self.restore(&state)
    }
}

fn unknown<'a>(what: &'static str, name: &str, names: impl Iterator<Item = &'a str>) -> RunError {
    let hint = crate::diagnostic::did_you_mean(name, names);
    let hint = hint.map_or(String::new(), |hint| format!("; {hint}"));
    RunError::UnknownName { what, name: name.to_owned(), hint }
}
