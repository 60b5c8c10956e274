# Written by crates/py/generate_grid.py from anergy.schema(): change it there.
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, TypedDict

from anergy._core import Model

__all__ = ["Grid"]

class _Stub(TypedDict, total=False):
    length_m: float
    length_mm: float
    length_cm: float
    length_km: float
    inner_diameter_m: float
    inner_diameter_mm: float
    inner_diameter_cm: float
    inner_diameter_km: float
    roughness_m: float
    roughness_mm: float
    roughness_cm: float
    roughness_km: float
    zeta: float
    friction: Literal["haaland", "colebrook", "swamee_jain", "hazen_williams", "chezy_manning"]
    transition: Literal["cubic", "linear", "dunlop"]
    hazen_williams_c: float
    manning_n: float
    fixed_velocity_m_s: float
    friction_factor: float
    delta_m: float
    insulation_resistance_k_m_w: float
    heat_loss_factor: float
    wall: Literal["none", "end_volume", "equilibrium", "film"]
    outer_diameter_m: float
    outer_diameter_mm: float
    outer_diameter_cm: float
    outer_diameter_km: float
    wall_density_kg_m3: float
    wall_heat_capacity_j_kg_k: float
    wall_heat_capacity_kj_kg_k: float
    wall_capacity_j_m_k: float
    wall_film_factor: float
    dispersion_m2_s: float
    standstill_loss_factor: float
    laying: Literal["buried", "twin", "above_ground"]
    wall_conductivity_w_m_k: float
    casing_diameter_m: float
    casing_diameter_mm: float
    casing_diameter_cm: float
    casing_diameter_km: float
    casing_thickness_m: float
    casing_thickness_mm: float
    casing_thickness_cm: float
    casing_thickness_km: float
    insulation_thickness_m: float
    insulation_thickness_mm: float
    insulation_thickness_cm: float
    insulation_thickness_km: float
    insulation_conductivity_w_m_k: float
    film_w_m2_k: float
    depth_m: float
    depth_mm: float
    depth_cm: float
    depth_km: float
    spacing_m: float
    spacing_mm: float
    spacing_cm: float
    spacing_km: float
    companion: str
    companion_reversed: bool
    soil_rings: int
    ground_capacity_j_m_k: float
    ground_share: float
    wind_m_s: float
    outer_film_w_m2_k: float
    surroundings_k: float
    surroundings_degc: float
    surroundings_difference_k: float
    initial_k: float
    initial_degc: float
    pipe: str

class _HeatExchanger(TypedDict, total=False):
    dp_nominal_pa: float
    dp_nominal_hpa: float
    dp_nominal_mbar: float
    dp_nominal_kpa: float
    dp_nominal_bar: float
    dp_nominal_mpa: float
    m_flow_nominal_kg_s: float
    m_flow_nominal_kg_min: float
    m_flow_nominal_kg_h: float
    m_flow_nominal_secondary_kg_s: float
    m_flow_nominal_secondary_kg_min: float
    m_flow_nominal_secondary_kg_h: float
    ua_w_k: float
    ua_kw_k: float
    flow_exponent: float
    arrangement: Literal["counter_flow", "parallel_flow"]
    equal_capacity_band: float
    volume_m3: float
    volume_l: float
    wall_capacity_j_k: float
    wall_capacity_kj_k: float
    delta_m: float
    partner: str

class _FeedInPump(TypedDict, total=False):
    head_max_pa: float
    head_max_hpa: float
    head_max_mbar: float
    head_max_kpa: float
    head_max_bar: float
    head_max_mpa: float
    free_flow_m3_s: float
    free_flow_l_s: float
    free_flow_l_min: float
    free_flow_l_h: float
    free_flow_m3_h: float
    curve_exponent: float
    curve_v_flow_m3_s: Sequence[float]
    curve_v_flow_l_s: Sequence[float]
    curve_v_flow_l_min: Sequence[float]
    curve_v_flow_l_h: Sequence[float]
    curve_v_flow_m3_h: Sequence[float]
    curve_head_pa: Sequence[float]
    curve_head_hpa: Sequence[float]
    curve_head_mbar: Sequence[float]
    curve_head_kpa: Sequence[float]
    curve_head_bar: Sequence[float]
    curve_head_mpa: Sequence[float]
    curve_polynomial: Sequence[float]
    curve_v_flow_max_m3_s: float
    curve_v_flow_max_l_s: float
    curve_v_flow_max_l_min: float
    curve_v_flow_max_l_h: float
    curve_v_flow_max_m3_h: float
    mode: Literal["speed", "flow", "head", "proportional_head"]
    m_flow_set_kg_s: float
    m_flow_set_kg_min: float
    m_flow_set_kg_h: float
    head_pa: float
    head_hpa: float
    head_mbar: float
    head_kpa: float
    head_bar: float
    head_mpa: float
    m_flow_design_kg_s: float
    m_flow_design_kg_min: float
    m_flow_design_kg_h: float
    zero_flow_share: float
    speed: float
    initial_speed: float
    speed_min: float
    speed_max: float
    reversible: bool
    rise_time_s: float
    rise_time_min: float
    rise_time_h: float
    rise_time_d: float
    efficiency_hydraulic: float
    efficiency_motor: float
    efficiency_v_flow_m3_s: Sequence[float]
    efficiency_v_flow_l_s: Sequence[float]
    efficiency_v_flow_l_min: Sequence[float]
    efficiency_v_flow_l_h: Sequence[float]
    efficiency_v_flow_m3_h: Sequence[float]
    efficiency: Sequence[float]
    heat_to_water: float
    standby_w: float
    standby_kw: float
    standby_mw: float
    delta_m: float

class _FeedInCheckValve(TypedDict, total=False):
    kvs_m3_h: float
    leakage: float
    m_flow_nominal_kg_s: float
    m_flow_nominal_kg_min: float
    m_flow_nominal_kg_h: float
    delta_m: float

class _ExtractionValve(TypedDict, total=False):
    kvs_m3_h: float
    characteristic: Literal["linear", "equal_percentage", "quick_opening", "table"]
    rangeability: float
    alpha: float
    table_opening: Sequence[float]
    table_phi: Sequence[float]
    leakage: float
    command: Literal["opening", "kappa"]
    command_of: str
    inverse: bool
    switch_at: float
    pulse_period_s: float
    pulse_period_min: float
    pulse_period_h: float
    pulse_period_d: float
    opening: float
    kappa: float
    initial_opening: float
    stroke_time_s: float
    stroke_time_min: float
    stroke_time_h: float
    stroke_time_d: float
    m_flow_nominal_kg_s: float
    m_flow_nominal_kg_min: float
    m_flow_nominal_kg_h: float
    delta_m: float

class _Generator(TypedDict, total=False):
    dp_nominal_pa: float
    dp_nominal_hpa: float
    dp_nominal_mbar: float
    dp_nominal_kpa: float
    dp_nominal_bar: float
    dp_nominal_mpa: float
    m_flow_nominal_kg_s: float
    m_flow_nominal_kg_min: float
    m_flow_nominal_kg_h: float
    kv_m3_h: float
    exponent: float
    curve_v_flow_m3_s: Sequence[float]
    curve_v_flow_l_s: Sequence[float]
    curve_v_flow_l_min: Sequence[float]
    curve_v_flow_l_h: Sequence[float]
    curve_v_flow_m3_h: Sequence[float]
    curve_dp_pa: Sequence[float]
    curve_dp_hpa: Sequence[float]
    curve_dp_mbar: Sequence[float]
    curve_dp_kpa: Sequence[float]
    curve_dp_bar: Sequence[float]
    curve_dp_mpa: Sequence[float]
    delta_m: float

class _ShutOff(TypedDict, total=False):
    kvs_m3_h: float
    leakage: float
    open: float
    initial_opening: float
    stroke_time_s: float
    stroke_time_min: float
    stroke_time_h: float
    stroke_time_d: float
    m_flow_nominal_kg_s: float
    m_flow_nominal_kg_min: float
    m_flow_nominal_kg_h: float
    delta_m: float

class _Map(TypedDict, total=False):
    file: str
    hplib_model: str
    hplib_title: str
    hplib_group: int
    hplib_heat_w: float
    hplib_electric_w: float
    hplib_power_coefficients: Sequence[float]
    hplib_ratio_coefficients: Sequence[float]
    cooling: bool
    modulation: Sequence[float]
    source_k: Sequence[float]
    return_k: Sequence[float]
    supply_k: Sequence[float]
    heat_w: Sequence[Sequence[float]]
    electric_w: Sequence[Sequence[float]]
    cop: Sequence[Sequence[float]]
    hplib_heat_kw: float
    hplib_heat_mw: float
    hplib_electric_kw: float
    hplib_electric_mw: float
    source_degc: Sequence[float]
    return_degc: Sequence[float]
    supply_degc: Sequence[float]
    heat_kw: Sequence[Sequence[float]]
    heat_mw: Sequence[Sequence[float]]
    electric_kw: Sequence[Sequence[float]]
    electric_mw: Sequence[Sequence[float]]

class _Positions(TypedDict, total=False):
    inlet_m: float
    outlet_m: float
    inlet_layer: int
    outlet_layer: int
    inlet_mm: float
    inlet_cm: float
    inlet_km: float
    outlet_mm: float
    outlet_cm: float
    outlet_km: float

class _Ports(TypedDict, total=False):
    inlet_m: float
    outlet_m: float
    inlet_layer: int
    outlet_layer: int
    positions: Sequence[_Positions]
    inlet_mm: float
    inlet_cm: float
    inlet_km: float
    outlet_mm: float
    outlet_cm: float
    outlet_km: float

class _Coils(TypedDict, total=False):
    area_m2: float
    u_w_m2_k: float
    volume_m3: float
    inlet_m: float
    outlet_m: float
    inlet_layer: int
    outlet_layer: int
    m_flow_nominal_kg_s: float
    flow_exponent: float
    nominal_difference_k: float
    difference_exponent: float
    area_cm2: float
    volume_l: float
    inlet_mm: float
    inlet_cm: float
    inlet_km: float
    outlet_mm: float
    outlet_cm: float
    outlet_km: float
    m_flow_nominal_kg_min: float
    m_flow_nominal_kg_h: float

class _Rod(TypedDict, total=False):
    power_w: float
    bottom_m: float
    top_m: float
    layer: int
    steps: int
    t_max_k: float
    hysteresis_k: float
    power_kw: float
    power_mw: float
    bottom_mm: float
    bottom_cm: float
    bottom_km: float
    top_mm: float
    top_cm: float
    top_km: float
    t_max_degc: float

class _StationType:
    def bidirectional(
        self,
        id: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        site: str | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[station_type.ID]` with kind = "bidirectional".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        id
            Its name.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        site
            The site it stands at.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def consumer(
        self,
        id: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        site: str | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[station_type.ID]` with kind = "consumer".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        id
            Its name.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        site
            The site it stands at.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def producer(
        self,
        id: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        site: str | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[station_type.ID]` with kind = "producer".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        id
            Its name.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        site
            The site it stands at.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def prescribed_flow(
        self,
        id: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        site: str | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[station_type.ID]` with kind = "prescribed_flow".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        id
            Its name.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        site
            The site it stands at.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def plant(
        self,
        id: str,
        *,
        type: str | None = None,
        site: str | None = None,
        name: str | None = None,
        supply_k: float | None = None,
        supply_degc: float | None = None,
        outdoor_curve_k: Sequence[Sequence[float]] | None = None,
        outdoor_curve_degc: Sequence[Sequence[float]] | None = None,
        outdoor_k: float | None = None,
        outdoor_degc: float | None = None,
        dp_pa: float | None = None,
        dp_hpa: float | None = None,
        dp_mbar: float | None = None,
        dp_kpa: float | None = None,
        dp_bar: float | None = None,
        dp_mpa: float | None = None,
        dp_at: Literal["plant", "worst_consumer"] | None = None,
        consumers: Sequence[str] | None = None,
        dp_integral_time_s: float | None = None,
        dp_integral_time_min: float | None = None,
        dp_integral_time_h: float | None = None,
        dp_integral_time_d: float | None = None,
        return_pressure_pa: float | None = None,
        return_pressure_hpa: float | None = None,
        return_pressure_mbar: float | None = None,
        return_pressure_kpa: float | None = None,
        return_pressure_bar: float | None = None,
        return_pressure_mpa: float | None = None,
        circulation_pump: _FeedInPump | None = None,
        generator: _Generator | None = None,
    ) -> str:
        """Adds `[station_type.ID]` with kind = "plant".

        `[[station]]` with `kind = "plant"`: gives water of a supply temperature to the hot line and holds a
        pressure difference.

        Parameters
        ----------
        id
            Its name.
        type
            Name of a station_type
        site
            The site it stands at.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        supply_k
            Temperature of the water it supplies, K; also the signal `SITE.unit.supply_k`. Also supply_degc.
        outdoor_curve_k
            Instead: points of outdoor and supply temperature, K. Also outdoor_curve_degc.
        outdoor_k
            Outdoor temperature while nothing drives the signal `SITE.unit.outdoor_k`, K. Also outdoor_degc.
        dp_pa
            Pressure difference that is held, Pa. Absent: the pump runs at its own `speed`. Also dp_hpa,
            dp_mbar, dp_kpa, dp_bar, dp_mpa.
        dp_at
            Where it is held. One of plant, worst_consumer. Default: plant.
        consumers
            Stations of which the worst is held, for example "c12.station". Absent: all consumers.
        dp_integral_time_s
            Time in which the head follows a constant deviation at the worst consumer by as much, s. Default:
            60.0. Also dp_integral_time_min, dp_integral_time_h, dp_integral_time_d.
        return_pressure_pa
            Pressure held at its cold side, above the atmosphere, Pa. Absent: it holds none. Also
            return_pressure_hpa, return_pressure_mbar, return_pressure_kpa, return_pressure_bar,
            return_pressure_mpa.
        circulation_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        generator
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        """
    def prosumer(
        self,
        id: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        site: str | None = None,
        name: str | None = None,
        directions: Literal["both", "feed_in", "extraction"] | None = None,
        extraction: Literal["pump", "valve"] | None = None,
        hydraulics: Literal["two_pumps", "one_pump"] | None = None,
        flow_control: Literal["pi", "quasi_steady", "ideal"] | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        dead_time_s: float | None = None,
        dead_time_min: float | None = None,
        dead_time_h: float | None = None,
        dead_time_d: float | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        hot: str | None = None,
        cold: str | None = None,
        stub: _Stub | None = None,
        interface: _Generator | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        shut_off: _ShutOff | None = None,
        extraction_pump: _FeedInPump | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        pump: _FeedInPump | None = None,
        check_valve: _FeedInCheckValve | None = None,
        way: _ExtractionValve | None = None,
    ) -> str:
        """Adds `[station_type.ID]` with kind = "prosumer".

        `[[station]]` with `kind = "prosumer"`: pumps deliver the flow that the unit asks for, in its
        direction.

        Parameters
        ----------
        id
            Its name.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        site
            The site it stands at.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        directions
            The directions it can deliver. One of both, feed_in, extraction. Default: both.
        extraction
            What makes the flow of extraction: a pump, or a valve where the hot line is under pressure. One of
            pump, valve. Default: pump.
        hydraulics
            A pump for each direction, or one between two three-way valves. One of two_pumps, one_pump.
            Default: two_pumps.
        flow_control
            How the flow is held. Absent: `pi` in steps up to a quarter of the integral time, else
            `quasi_steady`.
        gain
            Proportional gain of the PI control: speed or opening per kg/s. Default: 0.6.
        integral_time_s
            Integral time of the PI control, s. Default: 8.0. Also integral_time_min, integral_time_h,
            integral_time_d.
        dead_time_s
            Pause of the PI control when the direction changes, s. Default: 5.0. Also dead_time_min,
            dead_time_h, dead_time_d.
        volume_m3
            Mixed water on either side of the unit, m3. Default: 0.005. Also volume_l.
        ua_w_k
            Heat conductance of the water on either side to the surroundings, W/K. Default: 0.0. Also ua_kw_k.
        hot
            Node of the grid that stands for the hot line. Absent: that of the site.
        cold
            Node of the grid that stands for the cold line. Absent: that of the site.
        stub
            A pipe as written in a model file.
        interface
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        shut_off
            A ball valve as written in a model file.
        extraction_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        extraction_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        check_valve
            A check valve as written in a model file.
        way
            A control valve as written in a model file.
        """
    def balancing_unit(
        self,
        id: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        site: str | None = None,
        name: str | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        stub: _Stub | None = None,
        interface: _Generator | None = None,
        hydraulics: Literal["passive", "pumped"] | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        pump: _FeedInPump | None = None,
    ) -> str:
        """Adds `[station_type.ID]` with kind = "balancing_unit".

        `[[station]]` with `kind = "balancing_unit"`: the unit stands between the lines and takes what comes.

        Parameters
        ----------
        id
            Its name.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        site
            The site it stands at.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        volume_m3
            Mixed water on either side of the unit, m3. Default: 0.005. Also volume_l.
        ua_w_k
            Heat conductance of the water on either side to the surroundings, W/K. Default: 0.0. Also ua_kw_k.
        stub
            A pipe as written in a model file.
        interface
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        hydraulics
            Whether a pump keeps the lines at the same pressure. One of passive, pumped. Default: passive.
        gain
            Proportional gain of that pump: speed per Pa. Absent: 2e-5.
        integral_time_s
            Integral time of that pump, s. Absent: 8. Also integral_time_min, integral_time_h, integral_time_d.
        pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        """

class _Station:
    def bidirectional(
        self,
        site: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[[station]]` with kind = "bidirectional".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def consumer(
        self,
        site: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[[station]]` with kind = "consumer".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def producer(
        self,
        site: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[[station]]` with kind = "producer".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def prescribed_flow(
        self,
        site: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
    ) -> str:
        """Adds `[[station]]` with kind = "prescribed_flow".

        `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
        elements; what is not given has the published value of the laboratory's station.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        """
    def plant(
        self,
        site: str,
        *,
        type: str | None = None,
        name: str | None = None,
        supply_k: float | None = None,
        supply_degc: float | None = None,
        outdoor_curve_k: Sequence[Sequence[float]] | None = None,
        outdoor_curve_degc: Sequence[Sequence[float]] | None = None,
        outdoor_k: float | None = None,
        outdoor_degc: float | None = None,
        dp_pa: float | None = None,
        dp_hpa: float | None = None,
        dp_mbar: float | None = None,
        dp_kpa: float | None = None,
        dp_bar: float | None = None,
        dp_mpa: float | None = None,
        dp_at: Literal["plant", "worst_consumer"] | None = None,
        consumers: Sequence[str] | None = None,
        dp_integral_time_s: float | None = None,
        dp_integral_time_min: float | None = None,
        dp_integral_time_h: float | None = None,
        dp_integral_time_d: float | None = None,
        return_pressure_pa: float | None = None,
        return_pressure_hpa: float | None = None,
        return_pressure_mbar: float | None = None,
        return_pressure_kpa: float | None = None,
        return_pressure_bar: float | None = None,
        return_pressure_mpa: float | None = None,
        circulation_pump: _FeedInPump | None = None,
        generator: _Generator | None = None,
    ) -> str:
        """Adds `[[station]]` with kind = "plant".

        `[[station]]` with `kind = "plant"`: gives water of a supply temperature to the hot line and holds a
        pressure difference.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        supply_k
            Temperature of the water it supplies, K; also the signal `SITE.unit.supply_k`. Also supply_degc.
        outdoor_curve_k
            Instead: points of outdoor and supply temperature, K. Also outdoor_curve_degc.
        outdoor_k
            Outdoor temperature while nothing drives the signal `SITE.unit.outdoor_k`, K. Also outdoor_degc.
        dp_pa
            Pressure difference that is held, Pa. Absent: the pump runs at its own `speed`. Also dp_hpa,
            dp_mbar, dp_kpa, dp_bar, dp_mpa.
        dp_at
            Where it is held. One of plant, worst_consumer. Default: plant.
        consumers
            Stations of which the worst is held, for example "c12.station". Absent: all consumers.
        dp_integral_time_s
            Time in which the head follows a constant deviation at the worst consumer by as much, s. Default:
            60.0. Also dp_integral_time_min, dp_integral_time_h, dp_integral_time_d.
        return_pressure_pa
            Pressure held at its cold side, above the atmosphere, Pa. Absent: it holds none. Also
            return_pressure_hpa, return_pressure_mbar, return_pressure_kpa, return_pressure_bar,
            return_pressure_mpa.
        circulation_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        generator
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        """
    def prosumer(
        self,
        site: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        name: str | None = None,
        directions: Literal["both", "feed_in", "extraction"] | None = None,
        extraction: Literal["pump", "valve"] | None = None,
        hydraulics: Literal["two_pumps", "one_pump"] | None = None,
        flow_control: Literal["pi", "quasi_steady", "ideal"] | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        dead_time_s: float | None = None,
        dead_time_min: float | None = None,
        dead_time_h: float | None = None,
        dead_time_d: float | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        hot: str | None = None,
        cold: str | None = None,
        stub: _Stub | None = None,
        interface: _Generator | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        shut_off: _ShutOff | None = None,
        extraction_pump: _FeedInPump | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        pump: _FeedInPump | None = None,
        check_valve: _FeedInCheckValve | None = None,
        way: _ExtractionValve | None = None,
    ) -> str:
        """Adds `[[station]]` with kind = "prosumer".

        `[[station]]` with `kind = "prosumer"`: pumps deliver the flow that the unit asks for, in its
        direction.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        directions
            The directions it can deliver. One of both, feed_in, extraction. Default: both.
        extraction
            What makes the flow of extraction: a pump, or a valve where the hot line is under pressure. One of
            pump, valve. Default: pump.
        hydraulics
            A pump for each direction, or one between two three-way valves. One of two_pumps, one_pump.
            Default: two_pumps.
        flow_control
            How the flow is held. Absent: `pi` in steps up to a quarter of the integral time, else
            `quasi_steady`.
        gain
            Proportional gain of the PI control: speed or opening per kg/s. Default: 0.6.
        integral_time_s
            Integral time of the PI control, s. Default: 8.0. Also integral_time_min, integral_time_h,
            integral_time_d.
        dead_time_s
            Pause of the PI control when the direction changes, s. Default: 5.0. Also dead_time_min,
            dead_time_h, dead_time_d.
        volume_m3
            Mixed water on either side of the unit, m3. Default: 0.005. Also volume_l.
        ua_w_k
            Heat conductance of the water on either side to the surroundings, W/K. Default: 0.0. Also ua_kw_k.
        hot
            Node of the grid that stands for the hot line. Absent: that of the site.
        cold
            Node of the grid that stands for the cold line. Absent: that of the site.
        stub
            A pipe as written in a model file.
        interface
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        shut_off
            A ball valve as written in a model file.
        extraction_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        extraction_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        check_valve
            A check valve as written in a model file.
        way
            A control valve as written in a model file.
        """
    def balancing_unit(
        self,
        site: str,
        *,
        type: str | None = None,
        unit: Mapping[str, Any] | None = None,
        name: str | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        stub: _Stub | None = None,
        interface: _Generator | None = None,
        hydraulics: Literal["passive", "pumped"] | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        pump: _FeedInPump | None = None,
    ) -> str:
        """Adds `[[station]]` with kind = "balancing_unit".

        `[[station]]` with `kind = "balancing_unit"`: the unit stands between the lines and takes what comes.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        volume_m3
            Mixed water on either side of the unit, m3. Default: 0.005. Also volume_l.
        ua_w_k
            Heat conductance of the water on either side to the surroundings, W/K. Default: 0.0. Also ua_kw_k.
        stub
            A pipe as written in a model file.
        interface
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        hydraulics
            Whether a pump keeps the lines at the same pressure. One of passive, pumped. Default: passive.
        gain
            Proportional gain of that pump: speed per Pa. Absent: 2e-5.
        integral_time_s
            Integral time of that pump, s. Absent: 8. Also integral_time_min, integral_time_h, integral_time_d.
        pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        """
    def of_type(
        self,
        site: str,
        type: str,
        *,
        unit: Mapping[str, Any] | None = None,
        kind: Literal["balancing_unit"] | None = None,
        name: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        stub: _Stub | None = None,
        heat_exchanger: _HeatExchanger | None = None,
        feed_in_pump: _FeedInPump | None = None,
        feed_in_check_valve: _FeedInCheckValve | None = None,
        extraction_valve: _ExtractionValve | None = None,
        extraction_check_valve: _FeedInCheckValve | None = None,
        supply_k: float | None = None,
        supply_degc: float | None = None,
        outdoor_curve_k: Sequence[Sequence[float]] | None = None,
        outdoor_curve_degc: Sequence[Sequence[float]] | None = None,
        outdoor_k: float | None = None,
        outdoor_degc: float | None = None,
        dp_pa: float | None = None,
        dp_hpa: float | None = None,
        dp_mbar: float | None = None,
        dp_kpa: float | None = None,
        dp_bar: float | None = None,
        dp_mpa: float | None = None,
        dp_at: Literal["plant", "worst_consumer"] | None = None,
        consumers: Sequence[str] | None = None,
        dp_integral_time_s: float | None = None,
        dp_integral_time_min: float | None = None,
        dp_integral_time_h: float | None = None,
        dp_integral_time_d: float | None = None,
        return_pressure_pa: float | None = None,
        return_pressure_hpa: float | None = None,
        return_pressure_mbar: float | None = None,
        return_pressure_kpa: float | None = None,
        return_pressure_bar: float | None = None,
        return_pressure_mpa: float | None = None,
        circulation_pump: _FeedInPump | None = None,
        generator: _Generator | None = None,
        directions: Literal["both", "feed_in", "extraction"] | None = None,
        extraction: Literal["pump", "valve"] | None = None,
        hydraulics: Literal["passive", "pumped"] | None = None,
        flow_control: Literal["pi", "quasi_steady", "ideal"] | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        dead_time_s: float | None = None,
        dead_time_min: float | None = None,
        dead_time_h: float | None = None,
        dead_time_d: float | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        hot: str | None = None,
        cold: str | None = None,
        interface: _Generator | None = None,
        shut_off: _ShutOff | None = None,
        extraction_pump: _FeedInPump | None = None,
        pump: _FeedInPump | None = None,
        check_valve: _FeedInCheckValve | None = None,
        way: _ExtractionValve | None = None,
    ) -> str:
        """Adds `[[station]]`.

        A station of a `station_type`, which says what it is.

        Parameters
        ----------
        site
            The site it stands at.
        type
            Name of a station_type
        unit
            The unit behind it, like a [[unit]]
        kind
            What it can do One of balancing_unit.
        name
            Name within its site; another name than "station" also prefixes its parts. Default: station.
        requested_flow_m3_s
            Flow that its pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        stub
            A pipe as written in a model file.
        heat_exchanger
            A heat-exchanger side as written in a model file.
        feed_in_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        feed_in_check_valve
            A check valve as written in a model file.
        extraction_valve
            A control valve as written in a model file.
        extraction_check_valve
            A check valve as written in a model file.
        supply_k
            Temperature of the water it supplies, K; also the signal `SITE.unit.supply_k`. Also supply_degc.
        outdoor_curve_k
            Instead: points of outdoor and supply temperature, K. Also outdoor_curve_degc.
        outdoor_k
            Outdoor temperature while nothing drives the signal `SITE.unit.outdoor_k`, K. Also outdoor_degc.
        dp_pa
            Pressure difference that is held, Pa. Absent: the pump runs at its own `speed`. Also dp_hpa,
            dp_mbar, dp_kpa, dp_bar, dp_mpa.
        dp_at
            Where it is held. One of plant, worst_consumer. Default: plant.
        consumers
            Stations of which the worst is held, for example "c12.station". Absent: all consumers.
        dp_integral_time_s
            Time in which the head follows a constant deviation at the worst consumer by as much, s. Default:
            60.0. Also dp_integral_time_min, dp_integral_time_h, dp_integral_time_d.
        return_pressure_pa
            Pressure held at its cold side, above the atmosphere, Pa. Absent: it holds none. Also
            return_pressure_hpa, return_pressure_mbar, return_pressure_kpa, return_pressure_bar,
            return_pressure_mpa.
        circulation_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        generator
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        directions
            The directions it can deliver. One of both, feed_in, extraction. Default: both.
        extraction
            What makes the flow of extraction: a pump, or a valve where the hot line is under pressure. One of
            pump, valve. Default: pump.
        hydraulics
            Whether a pump keeps the lines at the same pressure. One of passive, pumped. Default: passive.
        flow_control
            How the flow is held. Absent: `pi` in steps up to a quarter of the integral time, else
            `quasi_steady`.
        gain
            Proportional gain of that pump: speed per Pa. Absent: 2e-5.
        integral_time_s
            Integral time of that pump, s. Absent: 8. Also integral_time_min, integral_time_h, integral_time_d.
        dead_time_s
            Pause of the PI control when the direction changes, s. Default: 5.0. Also dead_time_min,
            dead_time_h, dead_time_d.
        volume_m3
            Mixed water on either side of the unit, m3. Default: 0.005. Also volume_l.
        ua_w_k
            Heat conductance of the water on either side to the surroundings, W/K. Default: 0.0. Also ua_kw_k.
        hot
            Node of the grid that stands for the hot line. Absent: that of the site.
        cold
            Node of the grid that stands for the cold line. Absent: that of the site.
        interface
            A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`,
            or the two columns of a table.
        shut_off
            A ball valve as written in a model file.
        extraction_pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        pump
            A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
            `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
        check_valve
            A check valve as written in a model file.
        way
            A control valve as written in a model file.
        """

class _Edge:
    def pipe(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        pipe: str | None = None,
        length_m: float | None = None,
        length_mm: float | None = None,
        length_cm: float | None = None,
        length_km: float | None = None,
        inner_diameter_m: float | None = None,
        inner_diameter_mm: float | None = None,
        inner_diameter_cm: float | None = None,
        inner_diameter_km: float | None = None,
        roughness_m: float | None = None,
        roughness_mm: float | None = None,
        roughness_cm: float | None = None,
        roughness_km: float | None = None,
        zeta: float | None = None,
        friction: Literal["haaland", "colebrook", "swamee_jain", "hazen_williams", "chezy_manning"] | None = None,
        transition: Literal["cubic", "linear", "dunlop"] | None = None,
        hazen_williams_c: float | None = None,
        manning_n: float | None = None,
        fixed_velocity_m_s: float | None = None,
        friction_factor: float | None = None,
        delta_m: float | None = None,
        insulation_resistance_k_m_w: float | None = None,
        heat_loss_factor: float | None = None,
        wall: Literal["none", "end_volume", "equilibrium", "film"] | None = None,
        outer_diameter_m: float | None = None,
        outer_diameter_mm: float | None = None,
        outer_diameter_cm: float | None = None,
        outer_diameter_km: float | None = None,
        wall_density_kg_m3: float | None = None,
        wall_heat_capacity_j_kg_k: float | None = None,
        wall_heat_capacity_kj_kg_k: float | None = None,
        wall_capacity_j_m_k: float | None = None,
        wall_film_factor: float | None = None,
        dispersion_m2_s: float | None = None,
        standstill_loss_factor: float | None = None,
        laying: Literal["buried", "twin", "above_ground"] | None = None,
        wall_conductivity_w_m_k: float | None = None,
        casing_diameter_m: float | None = None,
        casing_diameter_mm: float | None = None,
        casing_diameter_cm: float | None = None,
        casing_diameter_km: float | None = None,
        casing_thickness_m: float | None = None,
        casing_thickness_mm: float | None = None,
        casing_thickness_cm: float | None = None,
        casing_thickness_km: float | None = None,
        insulation_thickness_m: float | None = None,
        insulation_thickness_mm: float | None = None,
        insulation_thickness_cm: float | None = None,
        insulation_thickness_km: float | None = None,
        insulation_conductivity_w_m_k: float | None = None,
        film_w_m2_k: float | None = None,
        depth_m: float | None = None,
        depth_mm: float | None = None,
        depth_cm: float | None = None,
        depth_km: float | None = None,
        spacing_m: float | None = None,
        spacing_mm: float | None = None,
        spacing_cm: float | None = None,
        spacing_km: float | None = None,
        companion: str | None = None,
        companion_reversed: bool | None = None,
        soil_rings: int | None = None,
        ground_capacity_j_m_k: float | None = None,
        ground_share: float | None = None,
        wind_m_s: float | None = None,
        outer_film_w_m2_k: float | None = None,
        surroundings_k: float | None = None,
        surroundings_degc: float | None = None,
        surroundings_difference_k: float | None = None,
        initial_k: float | None = None,
        initial_degc: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "pipe".

        A pipe as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        pipe
            Name of a pipe_type, or of a pipe of the catalogue
        length_m
            Length, m. Also length_mm, length_cm, length_km.
        inner_diameter_m
            Inner diameter, m. Also inner_diameter_mm, inner_diameter_cm, inner_diameter_km.
        roughness_m
            Wall roughness, m. Default: pre-insulated steel. Default: 5e-05. Also roughness_mm, roughness_cm,
            roughness_km.
        zeta
            Sum of the loss coefficients of the fittings. Default: 0.0.
        friction
            Friction correlation of turbulent flow. One of haaland, colebrook, swamee_jain, hazen_williams,
            chezy_manning. Default: haaland.
        transition
            Passage from laminar to turbulent flow. One of cubic, linear, dunlop. Default: cubic.
        hazen_williams_c
            Roughness coefficient C of Hazen-Williams; with `friction = "hazen_williams"` only.
        manning_n
            Manning's n, s/m^(1/3); with `friction = "chezy_manning"` only.
        fixed_velocity_m_s
            Freezes the friction factor at this velocity, m/s: a purely quadratic law.
        friction_factor
            A friction factor (Darcy: four times Fanning's) that holds at any flow, instead of a correlation.
        delta_m
            Below this share of the nominal flow a fixed coefficient is regularised. Default: 0.3.
        insulation_resistance_k_m_w
            Thermal resistance water to surroundings per length, K m/W. Absent: no heat loss.
        heat_loss_factor
            Heat loss over what the other fields say. Default: 1.0.
        wall
            How the wall of the medium pipe stores heat. One of none, end_volume, equilibrium, film. Default:
            none.
        outer_diameter_m
            Outer diameter of the medium pipe, m. Also outer_diameter_mm, outer_diameter_cm, outer_diameter_km.
        wall_density_kg_m3
            Density of the wall, kg/m3. Default: steel. Default: 7850.0.
        wall_heat_capacity_j_kg_k
            Specific heat capacity of the wall, J/(kg K). Default: steel. Default: 460.0. Also
            wall_heat_capacity_kj_kg_k.
        wall_capacity_j_m_k
            Heat capacity of the wall per length, J/(m K), in place of the one from its diameters.
        wall_film_factor
            Multiplies the heat transfer between water and wall with `wall = "film"`. Default: 1.0.
        dispersion_m2_s
            Axial dispersion coefficient of the water, m2/s; 0 keeps fronts sharp. Default: 0.0.
        standstill_loss_factor
            Multiplies the heat loss while the water stands still. Default: 1.0.
        laying
            How it lies: its heat loss then follows from its layers, in place of `insulation_resistance_k_m_w`.
        wall_conductivity_w_m_k
            Thermal conductivity of the wall, W/(m K). Absent: 50, steel.
        casing_diameter_m
            Outer diameter of the casing around the insulation, m. Absent, without `insulation_thickness_m`: no
            insulation. Also casing_diameter_mm, casing_diameter_cm, casing_diameter_km.
        casing_thickness_m
            Wall thickness of the casing (PE), m. Absent: none. Also casing_thickness_mm, casing_thickness_cm,
            casing_thickness_km.
        insulation_thickness_m
            Thickness of the insulation, m, instead of `casing_diameter_m`. Also insulation_thickness_mm,
            insulation_thickness_cm, insulation_thickness_km.
        insulation_conductivity_w_m_k
            Thermal conductivity of the insulation, W/(m K). Absent: 0.028, polyurethane foam.
        film_w_m2_k
            Heat transfer from water to wall, W/(m2 K). Absent: 3500.
        depth_m
            Depth of the axis below the ground, m; of a twin pipe that of its casing. Absent: that of
            `[ground]`. Also depth_mm, depth_cm, depth_km.
        spacing_m
            Distance of the axes of this pipe and its companion, m: they exchange heat. The two lines of a
            trench are companions. Also spacing_mm, spacing_cm, spacing_km.
        companion
            The pipe beside it, by name; given on one of the two.
        companion_reversed
            Whether port a of the companion lies beside port b.
        soil_rings
            Rings of soil around a pipe buried alone that store heat, 1 to 5. Absent: the soil stores none.
        ground_capacity_j_m_k
            Heat capacity around the pipe per length, J/(m K): one node in its thermal resistance. Absent:
            none.
        ground_share
            Share of the thermal resistance that lies beyond that node. Absent: 0.5.
        wind_m_s
            Wind across a pipe in the air, m/s. Absent: 1.
        outer_film_w_m2_k
            Heat transfer from jacket to air, W/(m2 K). Absent: radiation and wind.
        surroundings_k
            Temperature around the pipe, K. Absent: the ground temperature of the model. Also
            surroundings_degc.
        surroundings_difference_k
            Added to the temperature around the pipe, K. Default: 0.0.
        initial_k
            Temperature of the water at the start, K. Absent: the initial temperature of the run. Also
            initial_degc.
        """
    def pump(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        head_max_pa: float | None = None,
        head_max_hpa: float | None = None,
        head_max_mbar: float | None = None,
        head_max_kpa: float | None = None,
        head_max_bar: float | None = None,
        head_max_mpa: float | None = None,
        free_flow_m3_s: float | None = None,
        free_flow_l_s: float | None = None,
        free_flow_l_min: float | None = None,
        free_flow_l_h: float | None = None,
        free_flow_m3_h: float | None = None,
        curve_exponent: float | None = None,
        curve_v_flow_m3_s: Sequence[float] | None = None,
        curve_v_flow_l_s: Sequence[float] | None = None,
        curve_v_flow_l_min: Sequence[float] | None = None,
        curve_v_flow_l_h: Sequence[float] | None = None,
        curve_v_flow_m3_h: Sequence[float] | None = None,
        curve_head_pa: Sequence[float] | None = None,
        curve_head_hpa: Sequence[float] | None = None,
        curve_head_mbar: Sequence[float] | None = None,
        curve_head_kpa: Sequence[float] | None = None,
        curve_head_bar: Sequence[float] | None = None,
        curve_head_mpa: Sequence[float] | None = None,
        curve_polynomial: Sequence[float] | None = None,
        curve_v_flow_max_m3_s: float | None = None,
        curve_v_flow_max_l_s: float | None = None,
        curve_v_flow_max_l_min: float | None = None,
        curve_v_flow_max_l_h: float | None = None,
        curve_v_flow_max_m3_h: float | None = None,
        mode: Literal["speed", "flow", "head", "proportional_head"] | None = None,
        m_flow_set_kg_s: float | None = None,
        m_flow_set_kg_min: float | None = None,
        m_flow_set_kg_h: float | None = None,
        head_pa: float | None = None,
        head_hpa: float | None = None,
        head_mbar: float | None = None,
        head_kpa: float | None = None,
        head_bar: float | None = None,
        head_mpa: float | None = None,
        m_flow_design_kg_s: float | None = None,
        m_flow_design_kg_min: float | None = None,
        m_flow_design_kg_h: float | None = None,
        zero_flow_share: float | None = None,
        speed: float | None = None,
        initial_speed: float | None = None,
        speed_min: float | None = None,
        speed_max: float | None = None,
        reversible: bool | None = None,
        rise_time_s: float | None = None,
        rise_time_min: float | None = None,
        rise_time_h: float | None = None,
        rise_time_d: float | None = None,
        efficiency_hydraulic: float | None = None,
        efficiency_motor: float | None = None,
        efficiency_v_flow_m3_s: Sequence[float] | None = None,
        efficiency_v_flow_l_s: Sequence[float] | None = None,
        efficiency_v_flow_l_min: Sequence[float] | None = None,
        efficiency_v_flow_l_h: Sequence[float] | None = None,
        efficiency_v_flow_m3_h: Sequence[float] | None = None,
        efficiency: Sequence[float] | None = None,
        heat_to_water: float | None = None,
        standby_w: float | None = None,
        standby_kw: float | None = None,
        standby_mw: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "pump".

        A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
        `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        head_max_pa
            Head at zero flow and full speed, Pa (quadratic curve or power law). Also head_max_hpa,
            head_max_mbar, head_max_kpa, head_max_bar, head_max_mpa.
        free_flow_m3_s
            Flow at zero head and full speed, m3/s (quadratic curve or power law). Also free_flow_l_s,
            free_flow_l_min, free_flow_l_h, free_flow_m3_h.
        curve_exponent
            Exponent of the flow between the two. Absent: 2, the quadratic curve.
        curve_v_flow_m3_s
            Flows of the curve table at full speed, m3/s, rising from 0. Also curve_v_flow_l_s,
            curve_v_flow_l_min, curve_v_flow_l_h, curve_v_flow_m3_h.
        curve_head_pa
            Heads of the curve table, Pa, falling. Also curve_head_hpa, curve_head_mbar, curve_head_kpa,
            curve_head_bar, curve_head_mpa.
        curve_polynomial
            Head at full speed as a polynomial of the flow, Pa over m3/s: coefficients of increasing powers.
        curve_v_flow_max_m3_s
            Largest flow of the polynomial, m3/s. Absent: where its head becomes zero. Also
            curve_v_flow_max_l_s, curve_v_flow_max_l_min, curve_v_flow_max_l_h, curve_v_flow_max_m3_h.
        mode
            What the pump holds and its command means. One of speed, flow, head, proportional_head. Default:
            speed.
        m_flow_set_kg_s
            Mass flow commanded while nothing else drives it, kg/s, with `mode = "flow"`. Also
            m_flow_set_kg_min, m_flow_set_kg_h.
        head_pa
            Head commanded while nothing else drives it, Pa, with `mode = "head"`; with `mode =
            "proportional_head"` that from the design flow on. Also head_hpa, head_mbar, head_kpa, head_bar,
            head_mpa.
        m_flow_design_kg_s
            Flow from which on a proportional head is `head_pa`, kg/s. Absent: where the curve at full speed
            has this head. Also m_flow_design_kg_min, m_flow_design_kg_h.
        zero_flow_share
            Share of `head_pa` that a proportional head has at zero flow. Absent: half of it.
        speed
            Relative speed commanded while nothing else drives it. Default: 0.0.
        initial_speed
            Relative speed at the start of a run. Default: 0.0.
        speed_min
            Below this relative speed the pump is off. Default: 0.0.
        speed_max
            Largest relative speed. Default: 1.0.
        reversible
            Whether it turns both ways: a negative speed pumps from b to a, with the same curve.
        rise_time_s
            Time in which the speed, or what else is commanded, follows a step by 99.6 %, s. Default: 8.0. Also
            rise_time_min, rise_time_h, rise_time_d.
        efficiency_hydraulic
            Hydraulic efficiency. Default: 0.7.
        efficiency_motor
            Motor efficiency. Default: 0.7.
        efficiency_v_flow_m3_s
            Flows of the efficiency table at full speed, m3/s. Also efficiency_v_flow_l_s,
            efficiency_v_flow_l_min, efficiency_v_flow_l_h, efficiency_v_flow_m3_h.
        efficiency
            Overall efficiencies of the table, from wire to water, instead of the two constants.
        heat_to_water
            Share of the electric power (without the standby power) that ends in the water: 1 for a wet rotor,
            `efficiency_motor` for a dry motor in the open. Absent: the pump does not warm the water.
        standby_w
            Electric power while off, W. Default: 0.0. Also standby_kw, standby_mw.
        delta_m
            Regularised below this share of the nominal flow (half the free flow). Default: 0.01.
        """
    def valve(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        characteristic: Literal["linear", "equal_percentage", "quick_opening", "table"] | None = None,
        rangeability: float | None = None,
        alpha: float | None = None,
        table_opening: Sequence[float] | None = None,
        table_phi: Sequence[float] | None = None,
        leakage: float | None = None,
        command: Literal["opening", "kappa"] | None = None,
        command_of: str | None = None,
        inverse: bool | None = None,
        switch_at: float | None = None,
        pulse_period_s: float | None = None,
        pulse_period_min: float | None = None,
        pulse_period_h: float | None = None,
        pulse_period_d: float | None = None,
        opening: float | None = None,
        kappa: float | None = None,
        initial_opening: float | None = None,
        stroke_time_s: float | None = None,
        stroke_time_min: float | None = None,
        stroke_time_h: float | None = None,
        stroke_time_d: float | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "valve".

        A control valve as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        characteristic
            Flow coefficient over the stroke. One of linear, equal_percentage, quick_opening, table. Default:
            equal_percentage.
        rangeability
            Ratio of largest to smallest controllable coefficient (equal percentage). Default: 50.0.
        alpha
            Root of the opening that the coefficient follows (quick opening). Default: 2.0.
        table_opening
            Openings of the table, rising from 0 to 1.
        table_phi
            Relative flow coefficients of the table without the leakage, rising from 0 to 1.
        leakage
            Coefficient of the closed valve over that of the open one; 0 is tight. Default: 0.001.
        command
            What the command means. One of opening, kappa. Default: opening.
        command_of
            Name under which valves share one command, a signal `NAME.opening` (or `.kappa`). Absent: the
            command is its own.
        inverse
            Whether it takes one minus the command, like the second way of a three-way valve.
        switch_at
            Command from which on it opens fully, and below which it closes: a switching valve. Absent: it
            takes any opening.
        pulse_period_s
            Period of a pulsing valve, s: it is open for the share of each period that its command has at the
            beginning of the period, then closed. Absent: the command is an opening. Also pulse_period_min,
            pulse_period_h, pulse_period_d.
        opening
            Opening commanded while nothing drives it. Not with `command = "kappa"`.
        kappa
            Relative flow coefficient commanded while nothing drives it, with `command = "kappa"`.
        initial_opening
            Opening at the start of a run. Absent: where the first command leads.
        stroke_time_s
            Time in which the stem follows a step by 99.6 %, s. Default: 35.0. Also stroke_time_min,
            stroke_time_h, stroke_time_d.
        m_flow_nominal_kg_s
            Nominal flow for the regularisation, kg/s. Absent: flow at 0.1 bar when open. Also
            m_flow_nominal_kg_min, m_flow_nominal_kg_h.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.02.
        """
    def ball_valve(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        leakage: float | None = None,
        open: float | None = None,
        initial_opening: float | None = None,
        stroke_time_s: float | None = None,
        stroke_time_min: float | None = None,
        stroke_time_h: float | None = None,
        stroke_time_d: float | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "ball_valve".

        A ball valve as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when open.
        leakage
            Flow coefficient of the shut valve over that of the open one. Default: 0.0001.
        open
            Whether it is open while nothing drives it: 1 or 0. Default: 1.0.
        initial_opening
            Opening at the start of a run. Absent: where the first command leads.
        stroke_time_s
            Time in which it turns by 99.6 %, s. Default: 5.0. Also stroke_time_min, stroke_time_h,
            stroke_time_d.
        m_flow_nominal_kg_s
            Nominal flow for the regularisation, kg/s. Absent: flow at 0.1 bar when open. Also
            m_flow_nominal_kg_min, m_flow_nominal_kg_h.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.02.
        """
    def overflow_valve(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        opening_dp_pa: float | None = None,
        opening_dp_hpa: float | None = None,
        opening_dp_mbar: float | None = None,
        opening_dp_kpa: float | None = None,
        opening_dp_bar: float | None = None,
        opening_dp_mpa: float | None = None,
        band_dp_pa: float | None = None,
        band_dp_hpa: float | None = None,
        band_dp_mbar: float | None = None,
        band_dp_kpa: float | None = None,
        band_dp_bar: float | None = None,
        band_dp_mpa: float | None = None,
        leakage: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "overflow_valve".

        An overflow valve as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        opening_dp_pa
            Pressure difference from a to b at which it begins to open, Pa. Also opening_dp_hpa,
            opening_dp_mbar, opening_dp_kpa, opening_dp_bar, opening_dp_mpa.
        band_dp_pa
            Rise of the pressure difference over which it opens, Pa. Absent: a tenth of `opening_dp_pa`. Also
            band_dp_hpa, band_dp_mbar, band_dp_kpa, band_dp_bar, band_dp_mpa.
        leakage
            Flow coefficient of the shut valve over that of the open one. Default: 0.001.
        delta_m
            Regularised below this share of the flow at 0.1 bar. Default: 0.02.
        """
    def flow_limiter(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        m_flow_set_kg_s: float | None = None,
        m_flow_set_kg_min: float | None = None,
        m_flow_set_kg_h: float | None = None,
        rise_time_s: float | None = None,
        rise_time_min: float | None = None,
        rise_time_h: float | None = None,
        rise_time_d: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "flow_limiter".

        A flow limiter as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        m_flow_set_kg_s
            Largest flow from a to b while nothing drives it, kg/s. Also m_flow_set_kg_min, m_flow_set_kg_h.
        rise_time_s
            Time in which the set flow follows its command by 99.6 %, s. Default: 0.0. Also rise_time_min,
            rise_time_h, rise_time_d.
        delta_m
            Regularised below this share of the flow at 0.1 bar. Default: 0.02.
        """
    def dp_controller(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        high_node: str | None = None,
        low_node: str | None = None,
        dp_set_pa: float | None = None,
        dp_set_hpa: float | None = None,
        dp_set_mbar: float | None = None,
        dp_set_kpa: float | None = None,
        dp_set_bar: float | None = None,
        dp_set_mpa: float | None = None,
        band_dp_pa: float | None = None,
        band_dp_hpa: float | None = None,
        band_dp_mbar: float | None = None,
        band_dp_kpa: float | None = None,
        band_dp_bar: float | None = None,
        band_dp_mpa: float | None = None,
        lag_s: float | None = None,
        lag_min: float | None = None,
        lag_h: float | None = None,
        lag_d: float | None = None,
        leakage: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "dp_controller".

        A differential-pressure controller as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        high_node
            Node of the impulse line with the higher pressure.
        low_node
            Node of the impulse line with the lower pressure.
        dp_set_pa
            Pressure difference from which on it closes while nothing drives it, Pa. Also dp_set_hpa,
            dp_set_mbar, dp_set_kpa, dp_set_bar, dp_set_mpa.
        band_dp_pa
            Rise of the pressure difference over which it closes, Pa. Absent: a tenth of `dp_set_pa`. Also
            band_dp_hpa, band_dp_mbar, band_dp_kpa, band_dp_bar, band_dp_mpa.
        lag_s
            Time constant with which it follows, s. Default: 5.0. Also lag_min, lag_h, lag_d.
        leakage
            Flow coefficient of the shut valve over that of the open one. Default: 0.001.
        delta_m
            Regularised below this share of the flow at 0.1 bar. Default: 0.02.
        """
    def pressure_reducing_valve(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        pressure_set_pa: float | None = None,
        pressure_set_hpa: float | None = None,
        pressure_set_mbar: float | None = None,
        pressure_set_kpa: float | None = None,
        pressure_set_bar: float | None = None,
        pressure_set_mpa: float | None = None,
        sensed_node: str | None = None,
        band_pressure_pa: float | None = None,
        band_pressure_hpa: float | None = None,
        band_pressure_mbar: float | None = None,
        band_pressure_kpa: float | None = None,
        band_pressure_bar: float | None = None,
        band_pressure_mpa: float | None = None,
        lag_s: float | None = None,
        lag_min: float | None = None,
        lag_h: float | None = None,
        lag_d: float | None = None,
        leakage: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "pressure_reducing_valve".

        A pressure-reducing valve as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        pressure_set_pa
            Pressure above the atmosphere from which on it closes while nothing drives it, Pa. Also
            pressure_set_hpa, pressure_set_mbar, pressure_set_kpa, pressure_set_bar, pressure_set_mpa.
        sensed_node
            Node whose pressure it senses. Absent: that behind it, `to`.
        band_pressure_pa
            Rise of the pressure over which it closes, Pa. Absent: a tenth of `pressure_set_pa`. Also
            band_pressure_hpa, band_pressure_mbar, band_pressure_kpa, band_pressure_bar, band_pressure_mpa.
        lag_s
            Time constant with which it follows, s. Default: 5.0. Also lag_min, lag_h, lag_d.
        leakage
            Flow coefficient of the shut valve over that of the open one. Default: 0.001.
        delta_m
            Regularised below this share of the flow at 0.1 bar. Default: 0.02.
        """
    def pressure_sustaining_valve(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        pressure_set_pa: float | None = None,
        pressure_set_hpa: float | None = None,
        pressure_set_mbar: float | None = None,
        pressure_set_kpa: float | None = None,
        pressure_set_bar: float | None = None,
        pressure_set_mpa: float | None = None,
        sensed_node: str | None = None,
        band_pressure_pa: float | None = None,
        band_pressure_hpa: float | None = None,
        band_pressure_mbar: float | None = None,
        band_pressure_kpa: float | None = None,
        band_pressure_bar: float | None = None,
        band_pressure_mpa: float | None = None,
        lag_s: float | None = None,
        lag_min: float | None = None,
        lag_h: float | None = None,
        lag_d: float | None = None,
        leakage: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "pressure_sustaining_valve".

        A pressure-sustaining valve as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        pressure_set_pa
            Pressure above the atmosphere from which on it opens while nothing drives it, Pa. Also
            pressure_set_hpa, pressure_set_mbar, pressure_set_kpa, pressure_set_bar, pressure_set_mpa.
        sensed_node
            Node whose pressure it senses. Absent: that before it, `from`.
        band_pressure_pa
            Rise of the pressure over which it opens, Pa. Absent: a tenth of `pressure_set_pa`. Also
            band_pressure_hpa, band_pressure_mbar, band_pressure_kpa, band_pressure_bar, band_pressure_mpa.
        lag_s
            Time constant with which it follows, s. Default: 5.0. Also lag_min, lag_h, lag_d.
        leakage
            Flow coefficient of the shut valve over that of the open one. Default: 0.001.
        delta_m
            Regularised below this share of the flow at 0.1 bar. Default: 0.02.
        """
    def check_valve(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        kvs_m3_h: float | None = None,
        leakage: float | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "check_valve".

        A check valve as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        kvs_m3_h
            Flow in m3/h at 1 bar when open.
        leakage
            Flow coefficient of the closed valve over that of the open one. Default: 0.001.
        m_flow_nominal_kg_s
            Nominal flow for the regularisation, kg/s. Default: 0.3584. Also m_flow_nominal_kg_min,
            m_flow_nominal_kg_h.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.02.
        """
    def resistance(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        dp_nominal_pa: float | None = None,
        dp_nominal_hpa: float | None = None,
        dp_nominal_mbar: float | None = None,
        dp_nominal_kpa: float | None = None,
        dp_nominal_bar: float | None = None,
        dp_nominal_mpa: float | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        kv_m3_h: float | None = None,
        exponent: float | None = None,
        curve_v_flow_m3_s: Sequence[float] | None = None,
        curve_v_flow_l_s: Sequence[float] | None = None,
        curve_v_flow_l_min: Sequence[float] | None = None,
        curve_v_flow_l_h: Sequence[float] | None = None,
        curve_v_flow_m3_h: Sequence[float] | None = None,
        curve_dp_pa: Sequence[float] | None = None,
        curve_dp_hpa: Sequence[float] | None = None,
        curve_dp_mbar: Sequence[float] | None = None,
        curve_dp_kpa: Sequence[float] | None = None,
        curve_dp_bar: Sequence[float] | None = None,
        curve_dp_mpa: Sequence[float] | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "resistance".

        A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`, or
        the two columns of a table.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        dp_nominal_pa
            Pressure loss at the nominal flow, Pa. Also dp_nominal_hpa, dp_nominal_mbar, dp_nominal_kpa,
            dp_nominal_bar, dp_nominal_mpa.
        m_flow_nominal_kg_s
            Nominal flow, kg/s. Absent with `kv_m3_h`: the flow at 0.1 bar. Also m_flow_nominal_kg_min,
            m_flow_nominal_kg_h.
        kv_m3_h
            Flow in m3/h at 1 bar.
        exponent
            Exponent of the flow, with `dp_nominal_pa`. Absent: 2.
        curve_v_flow_m3_s
            Flows of the table, m3/s, rising from 0. Also curve_v_flow_l_s, curve_v_flow_l_min,
            curve_v_flow_l_h, curve_v_flow_m3_h.
        curve_dp_pa
            Pressure losses of the table, Pa, rising from 0. Also curve_dp_hpa, curve_dp_mbar, curve_dp_kpa,
            curve_dp_bar, curve_dp_mpa.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.3.
        """
    def heat_exchanger(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        dp_nominal_pa: float | None = None,
        dp_nominal_hpa: float | None = None,
        dp_nominal_mbar: float | None = None,
        dp_nominal_kpa: float | None = None,
        dp_nominal_bar: float | None = None,
        dp_nominal_mpa: float | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        m_flow_nominal_secondary_kg_s: float | None = None,
        m_flow_nominal_secondary_kg_min: float | None = None,
        m_flow_nominal_secondary_kg_h: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        flow_exponent: float | None = None,
        arrangement: Literal["counter_flow", "parallel_flow"] | None = None,
        equal_capacity_band: float | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        wall_capacity_j_k: float | None = None,
        wall_capacity_kj_k: float | None = None,
        delta_m: float | None = None,
        partner: str | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "heat_exchanger".

        A heat-exchanger side as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        dp_nominal_pa
            Pressure loss at the nominal flow, Pa. Default: 15500.0. Also dp_nominal_hpa, dp_nominal_mbar,
            dp_nominal_kpa, dp_nominal_bar, dp_nominal_mpa.
        m_flow_nominal_kg_s
            Nominal flow of this side, kg/s. Default: 0.3584. Also m_flow_nominal_kg_min, m_flow_nominal_kg_h.
        m_flow_nominal_secondary_kg_s
            Nominal flow of the other side, kg/s. Absent: as this side. Also m_flow_nominal_secondary_kg_min,
            m_flow_nominal_secondary_kg_h.
        ua_w_k
            UA at nominal flows, W/K. Default: 5955.1. Also ua_kw_k.
        flow_exponent
            Exponent of the film coefficients over the flow; 0 keeps UA constant. Default: 0.7.
        arrangement
            Arrangement at nominal directions. One of counter_flow, parallel_flow. Default: counter_flow.
        equal_capacity_band
            Where `|1 - Cmin/Cmax|` is below this, NTU/(1 + NTU) is used. Default: 1e-06.
        volume_m3
            Mixed water volume of each side, m3. Default: 0.003. Also volume_l.
        wall_capacity_j_k
            Heat capacity of the metal between the two sides, J/K: each side carries half of it. Absent: none.
            Default: 0.0. Also wall_capacity_kj_k.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.3.
        partner
            The edge that is the other side, in another circuit; then its UA counts and this one's not.
        """
    def heat_meter(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        return_node: str | None = None,
        supply_node: str | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        dp_nominal_pa: float | None = None,
        dp_nominal_hpa: float | None = None,
        dp_nominal_mbar: float | None = None,
        dp_nominal_kpa: float | None = None,
        dp_nominal_bar: float | None = None,
        dp_nominal_mpa: float | None = None,
        delta_m: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "heat_meter".

        A heat meter as written in a model file: with `return_node` or `supply_node`.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        return_node
            Node of the return sensor, where the flow sensor is in the supply.
        supply_node
            Node of the supply sensor, where the flow sensor is in the return.
        m_flow_nominal_kg_s
            Nominal (permanent) flow, kg/s. Also m_flow_nominal_kg_min, m_flow_nominal_kg_h.
        dp_nominal_pa
            Pressure loss at the nominal flow, Pa. Default: 25000.0. Also dp_nominal_hpa, dp_nominal_mbar,
            dp_nominal_kpa, dp_nominal_bar, dp_nominal_mpa.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.3.
        """
    def flow_source(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        m_flow_kg_s: float | None = None,
        m_flow_kg_min: float | None = None,
        m_flow_kg_h: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "flow_source".

        A prescribed flow as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        m_flow_kg_s
            Mass flow from a to b while nothing drives it, kg/s. Also m_flow_kg_min, m_flow_kg_h.
        v_flow_m3_s
            The same as a volume flow at the density of the medium, m3/s. Also v_flow_l_s, v_flow_l_min,
            v_flow_l_h, v_flow_m3_h.
        """
    def pressure_source(
        self,
        id: str,
        from_: str,
        to: str,
        *,
        head_pa: float | None = None,
        head_hpa: float | None = None,
        head_mbar: float | None = None,
        head_kpa: float | None = None,
        head_bar: float | None = None,
        head_mpa: float | None = None,
    ) -> str:
        """Adds `[[edge]]` with kind = "pressure_source".

        An ideal head source as written in a model file.

        Parameters
        ----------
        id
            Name of the edge
        from_
            Node at port a
        to
            Node at port b
        head_pa
            Pressure rise from a to b while nothing drives it, Pa. Also head_hpa, head_mbar, head_kpa,
            head_bar, head_mpa.
        """

class _Unit:
    def prescribed_source(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        supply_k: float | None = None,
        supply_degc: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "prescribed_source".

        A prescribed source as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        supply_k
            Temperature of the water the house sends, K. Also supply_degc.
        v_flow_m3_s
            Flow of that water, m3/s; behind an exchanger the flow of the house's circulation. Also v_flow_l_s,
            v_flow_l_min, v_flow_l_h, v_flow_m3_h.
        """
    def heat_load(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        load_w: float | None = None,
        load_kw: float | None = None,
        load_mw: float | None = None,
        load_max_w: float | None = None,
        load_max_kw: float | None = None,
        load_max_mw: float | None = None,
        return_k: float | None = None,
        return_degc: float | None = None,
        temperature_difference_k: float | None = None,
        v_flow_min_m3_s: float | None = None,
        v_flow_min_l_s: float | None = None,
        v_flow_min_l_min: float | None = None,
        v_flow_min_l_h: float | None = None,
        v_flow_min_m3_h: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        coldest_return_k: float | None = None,
        coldest_return_degc: float | None = None,
        supply_needed_k: float | None = None,
        supply_needed_degc: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "heat_load".

        A heat load as written in a model file: with `return_k` or `temperature_difference_k`.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        load_w
            Heat demand while no series drives it, W. Default: 0.0. Also load_kw, load_mw.
        load_max_w
            The largest power that an emulated load can take, W; what is demanded beyond is `unmet_w`. Absent:
            no limit. Also load_max_kw, load_max_mw.
        return_k
            Temperature of the returned water, K. Also return_degc.
        temperature_difference_k
            Difference of supplied and returned water, K.
        v_flow_min_m3_s
            By-pass: the smallest flow, m3/s. Default: 0.0. Also v_flow_min_l_s, v_flow_min_l_min,
            v_flow_min_l_h, v_flow_min_m3_h.
        v_flow_max_m3_s
            The largest flow, m3/s. Default: 0.001. Also v_flow_max_l_s, v_flow_max_l_min, v_flow_max_l_h,
            v_flow_max_m3_h.
        coldest_return_k
            The water is not cooled below this, K. Default: 278.15. Also coldest_return_degc.
        supply_needed_k
            Supply that the consumer needs, K: colder water while heat is demanded is counted as
            `shortfall_k_s` (indicator `shortfall_k_h`). Absent: not counted. Also supply_needed_degc.
        """
    def heat_source(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        supply_k: float | None = None,
        supply_degc: float | None = None,
        outdoor_curve_k: Sequence[Sequence[float]] | None = None,
        outdoor_curve_degc: Sequence[Sequence[float]] | None = None,
        outdoor_k: float | None = None,
        outdoor_degc: float | None = None,
        heat_w: float | None = None,
        heat_kw: float | None = None,
        heat_mw: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "heat_source".

        A heat source as written in a model file: with `supply_k`, `outdoor_curve_k` or `heat_w`.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        supply_k
            Temperature of the water that leaves, K. Also supply_degc.
        outdoor_curve_k
            Points of outdoor and supply temperature, K, by rising outdoor temperature. Also
            outdoor_curve_degc.
        outdoor_k
            Outdoor temperature while nothing drives it, K. Also outdoor_degc.
        heat_w
            Heat into the water that passes, whatever its flow and temperature, W; negative takes heat from it.
            Also heat_kw, heat_mw.
        """
    def air_source_heat_pump(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        mode: float | None = None,
        aux_modulation: float | None = None,
        enable: float | None = None,
        t_outdoor_k: float | None = None,
        t_outdoor_degc: float | None = None,
        relative_humidity: float | None = None,
        map: str | _Map | None = None,
        cooling_map: str | _Map | None = None,
        heat_nominal_w: float | None = None,
        heat_nominal_kw: float | None = None,
        heat_nominal_mw: float | None = None,
        cop_nominal: float | None = None,
        cop_max: float | None = None,
        return_dependence: Literal["product", "modulation_only"] | None = None,
        cold_nominal_w: float | None = None,
        cold_nominal_kw: float | None = None,
        cold_nominal_mw: float | None = None,
        eer_nominal: float | None = None,
        size_factor: float | None = None,
        modulation_min: float | None = None,
        speed_rise_s: float | None = None,
        speed_rise_min: float | None = None,
        speed_rise_h: float | None = None,
        speed_rise_d: float | None = None,
        flow_control: Literal["constant_temperature_difference", "constant_flow"] | None = None,
        temperature_difference_k: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
        heating_return_min_k: float | None = None,
        heating_return_min_degc: float | None = None,
        heating_return_max_k: float | None = None,
        heating_return_max_degc: float | None = None,
        cooling_return_min_k: float | None = None,
        cooling_return_min_degc: float | None = None,
        cooling_return_max_k: float | None = None,
        cooling_return_max_degc: float | None = None,
        restart_difference_k: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        source_min_k: float | None = None,
        source_min_degc: float | None = None,
        run_min_s: float | None = None,
        run_min_min: float | None = None,
        run_min_h: float | None = None,
        run_min_d: float | None = None,
        off_min_s: float | None = None,
        off_min_min: float | None = None,
        off_min_h: float | None = None,
        off_min_d: float | None = None,
        start_times_s: Sequence[float] | None = None,
        start_times_min: Sequence[float] | None = None,
        start_times_h: Sequence[float] | None = None,
        start_times_d: Sequence[float] | None = None,
        start_heat: Sequence[float] | None = None,
        start_power: Sequence[float] | None = None,
        flow_rise_s: float | None = None,
        flow_rise_min: float | None = None,
        flow_rise_h: float | None = None,
        flow_rise_d: float | None = None,
        warm_within_s: float | None = None,
        warm_within_min: float | None = None,
        warm_within_h: float | None = None,
        warm_within_d: float | None = None,
        warm_start_share: float | None = None,
        stop_s: float | None = None,
        stop_min: float | None = None,
        stop_h: float | None = None,
        stop_d: float | None = None,
        pump_overrun_s: float | None = None,
        pump_overrun_min: float | None = None,
        pump_overrun_h: float | None = None,
        pump_overrun_d: float | None = None,
        defrost: bool | None = None,
        frost_below_k: float | None = None,
        frost_below_degc: float | None = None,
        frost_after_s: float | None = None,
        frost_after_min: float | None = None,
        frost_after_h: float | None = None,
        frost_after_d: float | None = None,
        defrost_duration_s: float | None = None,
        defrost_duration_min: float | None = None,
        defrost_duration_h: float | None = None,
        defrost_duration_d: float | None = None,
        defrost_heat_w: float | None = None,
        defrost_heat_kw: float | None = None,
        defrost_heat_mw: float | None = None,
        defrost_electric_w: float | None = None,
        defrost_electric_kw: float | None = None,
        defrost_electric_mw: float | None = None,
        defrost_recovery_s: float | None = None,
        defrost_recovery_min: float | None = None,
        defrost_recovery_h: float | None = None,
        defrost_recovery_d: float | None = None,
        aux_rated_w: float | None = None,
        aux_rated_kw: float | None = None,
        aux_rated_mw: float | None = None,
        aux_steps: int | None = None,
        idle_w: float | None = None,
        idle_kw: float | None = None,
        idle_mw: float | None = None,
        efficiency_factor: float | None = None,
        part_load_factor: Sequence[float] | None = None,
        heat_share: float | None = None,
        content_m3: float | None = None,
        content_l: float | None = None,
        dynamics: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "air_source_heat_pump".

        An air-source heat pump as written in a model file; the defaults are those of the reference unit of 10
        kW.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Wanted speed as a share of the full one while nothing drives it; 0 is off. Default: 0.0.
        mode
            0 heating, 1 cooling, while nothing drives it. Default: 0.0.
        aux_modulation
            Wanted power of the electric heater as a share of its rated one while nothing drives it. Default:
            0.0.
        enable
            1 releases the unit, 0 keeps it off, while nothing drives it. Default: 1.0.
        t_outdoor_k
            Outdoor temperature while neither weather nor anything else drives it, K. Default: 275.15. Also
            t_outdoor_degc.
        relative_humidity
            Relative humidity of the air while neither weather nor anything else drives it, 0 to 1. Default:
            0.8.
        map
            Map of heating; the reference unit where none is given.
        cooling_map
            Map of cooling; without one a unit with a `map` only heats.
        heat_nominal_w
            Heat of the reference unit at air of 2 and water of 35 degC, W. Default: 5750.0. Also
            heat_nominal_kw, heat_nominal_mw.
        cop_nominal
            COP of the reference unit there. Default: 4.65.
        cop_max
            The COP of the reference unit is capped here.
        return_dependence
            What of the reference map depends on the return temperature. One of product, modulation_only.
            Default: product.
        cold_nominal_w
            Cold of the reference unit at air of 35 and water of 18 degC, W. Default: 6010.0. Also
            cold_nominal_kw, cold_nominal_mw.
        eer_nominal
            EER of the reference unit there. Default: 5.92.
        size_factor
            Factor on heat, cold and electricity: the size of the unit. Default: 1.0.
        modulation_min
            Smallest speed as a share of the full one. Default: 0.2.
        speed_rise_s
            Time in which the speed would rise from nothing to full, s; 0 at once. Default: 40.0. Also
            speed_rise_min, speed_rise_h, speed_rise_d.
        flow_control
            How the flow of the water is set. One of constant_temperature_difference, constant_flow. Default:
            constant_temperature_difference.
        temperature_difference_k
            Difference of supply and return with `constant_temperature_difference`, K. Default: 5.0.
        v_flow_m3_s
            Flow with `constant_flow`, m3/s. Default: 0.00048. Also v_flow_l_s, v_flow_l_min, v_flow_l_h,
            v_flow_m3_h.
        heating_return_min_k
            Heating stops where the water arrives colder, K. Default: 288.15. Also heating_return_min_degc.
        heating_return_max_k
            Heating stops where the water arrives warmer, K. Default: 341.15. Also heating_return_max_degc.
        cooling_return_min_k
            Cooling stops where the water arrives colder, K. Default: 280.15. Also cooling_return_min_degc.
        cooling_return_max_k
            Cooling stops where the water arrives warmer, K. Default: 303.15. Also cooling_return_max_degc.
        restart_difference_k
            How far inside its limits the temperature must be to start again, K. Default: 5.0.
        supply_max_k
            High-pressure cut-out: water that leaves the condenser warmer stops the unit, K. Default: 343.15.
            Also supply_max_degc.
        source_min_k
            Heating stops where the air is colder, K. Default: 248.15. Also source_min_degc.
        run_min_s
            Smallest time of a run, s. Default: 300.0. Also run_min_min, run_min_h, run_min_d.
        off_min_s
            Smallest time between a stop and the next start, s. Default: 300.0. Also off_min_min, off_min_h,
            off_min_d.
        start_times_s
            Start: times of its table, s, rising from 0. Default: [0.0, 30.0, 60.0, 120.0, 240.0, 420.0,
            600.0]. Also start_times_min, start_times_h, start_times_d.
        start_heat
            Start: heat at these times as a share of the steady one, negative where it is drawn from the water.
            Default: [0.0, -0.25, 0.0, 0.35, 0.7, 0.95, 1.0].
        start_power
            Start: electricity at these times as a share of the steady one. Default: [0.02, 0.05, 0.3, 0.8,
            1.1, 1.05, 1.0].
        flow_rise_s
            Time in which the flow rises after a start, s. Default: 10.0. Also flow_rise_min, flow_rise_h,
            flow_rise_d.
        warm_within_s
            A start after a shorter pause is a warm one, s. Default: 600.0. Also warm_within_min,
            warm_within_h, warm_within_d.
        warm_start_share
            Share of the times of the table in a warm start. Default: 0.4.
        stop_s
            Time in which the compressor stops, s. Default: 10.0. Also stop_min, stop_h, stop_d.
        pump_overrun_s
            How long the pump runs after the command to stop, s. Default: 60.0. Also pump_overrun_min,
            pump_overrun_h, pump_overrun_d.
        defrost
            Whether the unit removes frost. Default: True.
        frost_below_k
            Air colder than this makes frost, K; warmer air melts it. Default: 278.15. Also frost_below_degc.
        frost_after_s
            Operation in such air of 80 % humidity until the frost is removed, s. Default: 2700.0. Also
            frost_after_min, frost_after_h, frost_after_d.
        defrost_duration_s
            Duration of a defrost, s. Default: 300.0. Also defrost_duration_min, defrost_duration_h,
            defrost_duration_d.
        defrost_heat_w
            Heat taken from the water in a defrost at full speed, W; at least 60 % of it. Default: 5000.0. Also
            defrost_heat_kw, defrost_heat_mw.
        defrost_electric_w
            Electricity in a defrost, W. Default: 1200.0. Also defrost_electric_kw, defrost_electric_mw.
        defrost_recovery_s
            Ramp back to the steady heat after a defrost, s. Default: 120.0. Also defrost_recovery_min,
            defrost_recovery_h, defrost_recovery_d.
        aux_rated_w
            Rated power of the electric heater behind the condenser, W; 0 for none. Default: 9000.0. Also
            aux_rated_kw, aux_rated_mw.
        aux_steps
            Steps of the electric heater; 0 for any power. Default: 3.
        idle_w
            Electricity while the unit is off, W. Default: 15.0. Also idle_kw, idle_mw.
        efficiency_factor
            COP and EER over what the map says, at all loads. Default: 1.0.
        part_load_factor
            The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
        heat_share
            Share of the electricity of the compressor that becomes heat of the refrigerant; the rest warms the
            room. Default: 0.95.
        content_m3
            Water in the unit and its pipes, mixed with what leaves, m3; 0 for none. Default: 0.004. Also
            content_l.
        dynamics
            false: the steady map at once, without start, speed limit, frost, pump overrun, least times and
            content. Default: True.
        """
    def booster_heat_pump(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        mode: float | None = None,
        aux_modulation: float | None = None,
        enable: float | None = None,
        t_outdoor_k: float | None = None,
        t_outdoor_degc: float | None = None,
        map: str | _Map | None = None,
        cooling_map: str | _Map | None = None,
        rated_heat_w: float | None = None,
        rated_heat_kw: float | None = None,
        rated_heat_mw: float | None = None,
        rated_cold_w: float | None = None,
        rated_cold_kw: float | None = None,
        rated_cold_mw: float | None = None,
        carnot_share: float | None = None,
        part_load_gain: float | None = None,
        approach_difference_k: float | None = None,
        lift_min_difference_k: float | None = None,
        heat_slope: float | None = None,
        cop_max: float | None = None,
        modulation_min: float | None = None,
        speed_rise_s: float | None = None,
        speed_rise_min: float | None = None,
        speed_rise_h: float | None = None,
        speed_rise_d: float | None = None,
        start_s: float | None = None,
        start_min: float | None = None,
        start_h: float | None = None,
        start_d: float | None = None,
        flow_rise_s: float | None = None,
        flow_rise_min: float | None = None,
        flow_rise_h: float | None = None,
        flow_rise_d: float | None = None,
        stop_s: float | None = None,
        stop_min: float | None = None,
        stop_h: float | None = None,
        stop_d: float | None = None,
        pump_overrun_s: float | None = None,
        pump_overrun_min: float | None = None,
        pump_overrun_h: float | None = None,
        pump_overrun_d: float | None = None,
        run_min_s: float | None = None,
        run_min_min: float | None = None,
        run_min_h: float | None = None,
        run_min_d: float | None = None,
        off_min_s: float | None = None,
        off_min_min: float | None = None,
        off_min_h: float | None = None,
        off_min_d: float | None = None,
        grid_flow_control: Literal["constant_temperature_difference", "constant_flow"] | None = None,
        grid_temperature_difference_k: float | None = None,
        grid_v_flow_min_m3_s: float | None = None,
        grid_v_flow_min_l_s: float | None = None,
        grid_v_flow_min_l_min: float | None = None,
        grid_v_flow_min_l_h: float | None = None,
        grid_v_flow_min_m3_h: float | None = None,
        grid_v_flow_max_m3_s: float | None = None,
        grid_v_flow_max_l_s: float | None = None,
        grid_v_flow_max_l_min: float | None = None,
        grid_v_flow_max_l_h: float | None = None,
        grid_v_flow_max_m3_h: float | None = None,
        grid_v_flow_m3_s: float | None = None,
        grid_v_flow_l_s: float | None = None,
        grid_v_flow_l_min: float | None = None,
        grid_v_flow_l_h: float | None = None,
        grid_v_flow_m3_h: float | None = None,
        grid_coldest_k: float | None = None,
        grid_coldest_degc: float | None = None,
        house_flow_control: Literal["constant_temperature_difference", "constant_flow"] | None = None,
        house_temperature_difference_k: float | None = None,
        house_v_flow_m3_s: float | None = None,
        house_v_flow_l_s: float | None = None,
        house_v_flow_l_min: float | None = None,
        house_v_flow_l_h: float | None = None,
        house_v_flow_m3_h: float | None = None,
        reversed_for_cold: bool | None = None,
        heating_return_min_k: float | None = None,
        heating_return_min_degc: float | None = None,
        heating_return_max_k: float | None = None,
        heating_return_max_degc: float | None = None,
        cooling_return_min_k: float | None = None,
        cooling_return_min_degc: float | None = None,
        cooling_return_max_k: float | None = None,
        cooling_return_max_degc: float | None = None,
        restart_difference_k: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        exchanger_ua_w_k: float | None = None,
        exchanger_ua_kw_k: float | None = None,
        exchanger_approach_difference_k: float | None = None,
        aux_rated_w: float | None = None,
        aux_rated_kw: float | None = None,
        aux_rated_mw: float | None = None,
        aux_steps: int | None = None,
        idle_w: float | None = None,
        idle_kw: float | None = None,
        idle_mw: float | None = None,
        heat_share: float | None = None,
        dynamics: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "booster_heat_pump".

        A booster heat pump as written in a model file; the defaults are those of the laboratory's (19 kW heat,
        14 kW cold).

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Wanted speed as a share of the full one while nothing drives it; 0 is off. Default: 0.0.
        mode
            0 heating, 1 cooling, while nothing drives it. Default: 0.0.
        aux_modulation
            Wanted power of the rod as a share of its rated one while nothing drives it. Default: 0.0.
        enable
            1 releases the unit, 0 keeps it off, while nothing drives it. Default: 1.0.
        t_outdoor_k
            Outdoor temperature while neither weather nor anything else drives it, K: only maps of hplib ask
            for it. Default: 275.15. Also t_outdoor_degc.
        map
            Map of heating; a share of Carnot where none is given.
        cooling_map
            Map of cooling; without one a unit with a `map` only heats.
        rated_heat_w
            Heat at full speed and grid water of 10 degC, W. Default: 19000.0. Also rated_heat_kw,
            rated_heat_mw.
        rated_cold_w
            Cold at full speed, W. Default: 14000.0. Also rated_cold_kw, rated_cold_mw.
        carnot_share
            Share of Carnot at full speed. Default: 0.5.
        part_load_gain
            How much the share gains towards no speed, relative. Default: 0.12.
        approach_difference_k
            Water to refrigerant on both sides, K, as a difference. Default: 3.0.
        lift_min_difference_k
            Least difference of condensing and evaporating temperature, K. Default: 10.0.
        heat_slope
            Change of the heat with the temperature of the grid water, 1/K, relative: within 0.6 to 1.3.
            Default: 0.025.
        cop_max
            COP and EER are capped here.
        modulation_min
            Smallest speed as a share of the full one. Default: 0.25.
        speed_rise_s
            Time in which the speed would rise from nothing to full, s; 0 at once. Default: 40.0. Also
            speed_rise_min, speed_rise_h, speed_rise_d.
        start_s
            Ramp of heat and electricity after a start, s. Default: 120.0. Also start_min, start_h, start_d.
        flow_rise_s
            Time in which the flows rise after a start, s. Default: 10.0. Also flow_rise_min, flow_rise_h,
            flow_rise_d.
        stop_s
            Time in which the compressor stops, s. Default: 10.0. Also stop_min, stop_h, stop_d.
        pump_overrun_s
            How long the pumps run after the command to stop, s. Default: 60.0. Also pump_overrun_min,
            pump_overrun_h, pump_overrun_d.
        run_min_s
            Smallest time of a run, s. Default: 300.0. Also run_min_min, run_min_h, run_min_d.
        off_min_s
            Smallest time between a stop and the next start, s. Default: 300.0. Also off_min_min, off_min_h,
            off_min_d.
        grid_flow_control
            How the flow of the grid is set. One of constant_temperature_difference, constant_flow. Default:
            constant_temperature_difference.
        grid_temperature_difference_k
            Change of the grid water with `constant_temperature_difference`, K. Default: 5.0.
        grid_v_flow_min_m3_s
            Smallest flow of the grid with `constant_temperature_difference`, m3/s. Default:
            3.3333333333333335e-05. Also grid_v_flow_min_l_s, grid_v_flow_min_l_min, grid_v_flow_min_l_h,
            grid_v_flow_min_m3_h.
        grid_v_flow_max_m3_s
            Largest flow of the grid with `constant_temperature_difference`, m3/s. Default:
            0.0004166666666666667. Also grid_v_flow_max_l_s, grid_v_flow_max_l_min, grid_v_flow_max_l_h,
            grid_v_flow_max_m3_h.
        grid_v_flow_m3_s
            Flow of the grid with `constant_flow`, m3/s. Default: 0.0002. Also grid_v_flow_l_s,
            grid_v_flow_l_min, grid_v_flow_l_h, grid_v_flow_m3_h.
        grid_coldest_k
            The grid water is not cooled below this, K: the speed is reduced first. Default: 277.15. Also
            grid_coldest_degc.
        house_flow_control
            How the flow of the house is set. One of constant_temperature_difference, constant_flow. Default:
            constant_temperature_difference.
        house_temperature_difference_k
            Difference of supply and return of the house with `constant_temperature_difference`, K. Default:
            5.0.
        house_v_flow_m3_s
            Flow of the house with `constant_flow`, and through the plate exchanger, m3/s. Default: 0.0005.
            Also house_v_flow_l_s, house_v_flow_l_min, house_v_flow_l_h, house_v_flow_m3_h.
        reversed_for_cold
            Whether the grid water flows from the cold to the hot line while the house is cooled: true alone,
            false in a transfer station.
        heating_return_min_k
            Heating stops where the water of the house arrives colder, K. Default: 278.15. Also
            heating_return_min_degc.
        heating_return_max_k
            Heating stops where the water of the house arrives warmer, K. Default: 338.15. Also
            heating_return_max_degc.
        cooling_return_min_k
            Cooling stops where the water of the house arrives colder, K. Default: 279.15. Also
            cooling_return_min_degc.
        cooling_return_max_k
            Cooling stops where the water of the house arrives warmer, K. Default: 303.15. Also
            cooling_return_max_degc.
        restart_difference_k
            How far inside its limits the temperature must be to start again, K. Default: 5.0.
        supply_max_k
            High-pressure cut-out: water that leaves the condenser warmer stops the unit, K. Default: 343.15.
            Also supply_max_degc.
        exchanger_ua_w_k
            Conductance of a plate exchanger in parallel, W/K, 0 for none: 0 alone, 3000 in a transfer station.
            Also exchanger_ua_kw_k.
        exchanger_approach_difference_k
            The exchanger heats where the grid is warmer than the return of the house by more than this, K; it
            cools where the grid is colder by more than this. Default: 2.0.
        aux_rated_w
            Rated power of the electric rod behind both, W, 0 for none: 0 alone, 6000 in a transfer station.
            Also aux_rated_kw, aux_rated_mw.
        aux_steps
            Steps of the rod; 0 for any power. Default: 0.
        idle_w
            Electricity while the unit is off, W. Default: 15.0. Also idle_kw, idle_mw.
        heat_share
            Share of the electricity of the compressor that becomes heat of the refrigerant; the rest warms the
            room. Default: 0.95.
        dynamics
            false: the steady map at once, without start, speed limit, pump overrun and least times. Default:
            True.
        """
    def booster_transfer_station(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        mode: float | None = None,
        aux_modulation: float | None = None,
        enable: float | None = None,
        t_outdoor_k: float | None = None,
        t_outdoor_degc: float | None = None,
        map: str | _Map | None = None,
        cooling_map: str | _Map | None = None,
        rated_heat_w: float | None = None,
        rated_heat_kw: float | None = None,
        rated_heat_mw: float | None = None,
        rated_cold_w: float | None = None,
        rated_cold_kw: float | None = None,
        rated_cold_mw: float | None = None,
        carnot_share: float | None = None,
        part_load_gain: float | None = None,
        approach_difference_k: float | None = None,
        lift_min_difference_k: float | None = None,
        heat_slope: float | None = None,
        cop_max: float | None = None,
        modulation_min: float | None = None,
        speed_rise_s: float | None = None,
        speed_rise_min: float | None = None,
        speed_rise_h: float | None = None,
        speed_rise_d: float | None = None,
        start_s: float | None = None,
        start_min: float | None = None,
        start_h: float | None = None,
        start_d: float | None = None,
        flow_rise_s: float | None = None,
        flow_rise_min: float | None = None,
        flow_rise_h: float | None = None,
        flow_rise_d: float | None = None,
        stop_s: float | None = None,
        stop_min: float | None = None,
        stop_h: float | None = None,
        stop_d: float | None = None,
        pump_overrun_s: float | None = None,
        pump_overrun_min: float | None = None,
        pump_overrun_h: float | None = None,
        pump_overrun_d: float | None = None,
        run_min_s: float | None = None,
        run_min_min: float | None = None,
        run_min_h: float | None = None,
        run_min_d: float | None = None,
        off_min_s: float | None = None,
        off_min_min: float | None = None,
        off_min_h: float | None = None,
        off_min_d: float | None = None,
        grid_flow_control: Literal["constant_temperature_difference", "constant_flow"] | None = None,
        grid_temperature_difference_k: float | None = None,
        grid_v_flow_min_m3_s: float | None = None,
        grid_v_flow_min_l_s: float | None = None,
        grid_v_flow_min_l_min: float | None = None,
        grid_v_flow_min_l_h: float | None = None,
        grid_v_flow_min_m3_h: float | None = None,
        grid_v_flow_max_m3_s: float | None = None,
        grid_v_flow_max_l_s: float | None = None,
        grid_v_flow_max_l_min: float | None = None,
        grid_v_flow_max_l_h: float | None = None,
        grid_v_flow_max_m3_h: float | None = None,
        grid_v_flow_m3_s: float | None = None,
        grid_v_flow_l_s: float | None = None,
        grid_v_flow_l_min: float | None = None,
        grid_v_flow_l_h: float | None = None,
        grid_v_flow_m3_h: float | None = None,
        grid_coldest_k: float | None = None,
        grid_coldest_degc: float | None = None,
        house_flow_control: Literal["constant_temperature_difference", "constant_flow"] | None = None,
        house_temperature_difference_k: float | None = None,
        house_v_flow_m3_s: float | None = None,
        house_v_flow_l_s: float | None = None,
        house_v_flow_l_min: float | None = None,
        house_v_flow_l_h: float | None = None,
        house_v_flow_m3_h: float | None = None,
        reversed_for_cold: bool | None = None,
        heating_return_min_k: float | None = None,
        heating_return_min_degc: float | None = None,
        heating_return_max_k: float | None = None,
        heating_return_max_degc: float | None = None,
        cooling_return_min_k: float | None = None,
        cooling_return_min_degc: float | None = None,
        cooling_return_max_k: float | None = None,
        cooling_return_max_degc: float | None = None,
        restart_difference_k: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        exchanger_ua_w_k: float | None = None,
        exchanger_ua_kw_k: float | None = None,
        exchanger_approach_difference_k: float | None = None,
        aux_rated_w: float | None = None,
        aux_rated_kw: float | None = None,
        aux_rated_mw: float | None = None,
        aux_steps: int | None = None,
        idle_w: float | None = None,
        idle_kw: float | None = None,
        idle_mw: float | None = None,
        heat_share: float | None = None,
        dynamics: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "booster_transfer_station".

        A booster heat pump as written in a model file; the defaults are those of the laboratory's (19 kW heat,
        14 kW cold).

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Wanted speed as a share of the full one while nothing drives it; 0 is off. Default: 0.0.
        mode
            0 heating, 1 cooling, while nothing drives it. Default: 0.0.
        aux_modulation
            Wanted power of the rod as a share of its rated one while nothing drives it. Default: 0.0.
        enable
            1 releases the unit, 0 keeps it off, while nothing drives it. Default: 1.0.
        t_outdoor_k
            Outdoor temperature while neither weather nor anything else drives it, K: only maps of hplib ask
            for it. Default: 275.15. Also t_outdoor_degc.
        map
            Map of heating; a share of Carnot where none is given.
        cooling_map
            Map of cooling; without one a unit with a `map` only heats.
        rated_heat_w
            Heat at full speed and grid water of 10 degC, W. Default: 19000.0. Also rated_heat_kw,
            rated_heat_mw.
        rated_cold_w
            Cold at full speed, W. Default: 14000.0. Also rated_cold_kw, rated_cold_mw.
        carnot_share
            Share of Carnot at full speed. Default: 0.5.
        part_load_gain
            How much the share gains towards no speed, relative. Default: 0.12.
        approach_difference_k
            Water to refrigerant on both sides, K, as a difference. Default: 3.0.
        lift_min_difference_k
            Least difference of condensing and evaporating temperature, K. Default: 10.0.
        heat_slope
            Change of the heat with the temperature of the grid water, 1/K, relative: within 0.6 to 1.3.
            Default: 0.025.
        cop_max
            COP and EER are capped here.
        modulation_min
            Smallest speed as a share of the full one. Default: 0.25.
        speed_rise_s
            Time in which the speed would rise from nothing to full, s; 0 at once. Default: 40.0. Also
            speed_rise_min, speed_rise_h, speed_rise_d.
        start_s
            Ramp of heat and electricity after a start, s. Default: 120.0. Also start_min, start_h, start_d.
        flow_rise_s
            Time in which the flows rise after a start, s. Default: 10.0. Also flow_rise_min, flow_rise_h,
            flow_rise_d.
        stop_s
            Time in which the compressor stops, s. Default: 10.0. Also stop_min, stop_h, stop_d.
        pump_overrun_s
            How long the pumps run after the command to stop, s. Default: 60.0. Also pump_overrun_min,
            pump_overrun_h, pump_overrun_d.
        run_min_s
            Smallest time of a run, s. Default: 300.0. Also run_min_min, run_min_h, run_min_d.
        off_min_s
            Smallest time between a stop and the next start, s. Default: 300.0. Also off_min_min, off_min_h,
            off_min_d.
        grid_flow_control
            How the flow of the grid is set. One of constant_temperature_difference, constant_flow. Default:
            constant_temperature_difference.
        grid_temperature_difference_k
            Change of the grid water with `constant_temperature_difference`, K. Default: 5.0.
        grid_v_flow_min_m3_s
            Smallest flow of the grid with `constant_temperature_difference`, m3/s. Default:
            3.3333333333333335e-05. Also grid_v_flow_min_l_s, grid_v_flow_min_l_min, grid_v_flow_min_l_h,
            grid_v_flow_min_m3_h.
        grid_v_flow_max_m3_s
            Largest flow of the grid with `constant_temperature_difference`, m3/s. Default:
            0.0004166666666666667. Also grid_v_flow_max_l_s, grid_v_flow_max_l_min, grid_v_flow_max_l_h,
            grid_v_flow_max_m3_h.
        grid_v_flow_m3_s
            Flow of the grid with `constant_flow`, m3/s. Default: 0.0002. Also grid_v_flow_l_s,
            grid_v_flow_l_min, grid_v_flow_l_h, grid_v_flow_m3_h.
        grid_coldest_k
            The grid water is not cooled below this, K: the speed is reduced first. Default: 277.15. Also
            grid_coldest_degc.
        house_flow_control
            How the flow of the house is set. One of constant_temperature_difference, constant_flow. Default:
            constant_temperature_difference.
        house_temperature_difference_k
            Difference of supply and return of the house with `constant_temperature_difference`, K. Default:
            5.0.
        house_v_flow_m3_s
            Flow of the house with `constant_flow`, and through the plate exchanger, m3/s. Default: 0.0005.
            Also house_v_flow_l_s, house_v_flow_l_min, house_v_flow_l_h, house_v_flow_m3_h.
        reversed_for_cold
            Whether the grid water flows from the cold to the hot line while the house is cooled: true alone,
            false in a transfer station.
        heating_return_min_k
            Heating stops where the water of the house arrives colder, K. Default: 278.15. Also
            heating_return_min_degc.
        heating_return_max_k
            Heating stops where the water of the house arrives warmer, K. Default: 338.15. Also
            heating_return_max_degc.
        cooling_return_min_k
            Cooling stops where the water of the house arrives colder, K. Default: 279.15. Also
            cooling_return_min_degc.
        cooling_return_max_k
            Cooling stops where the water of the house arrives warmer, K. Default: 303.15. Also
            cooling_return_max_degc.
        restart_difference_k
            How far inside its limits the temperature must be to start again, K. Default: 5.0.
        supply_max_k
            High-pressure cut-out: water that leaves the condenser warmer stops the unit, K. Default: 343.15.
            Also supply_max_degc.
        exchanger_ua_w_k
            Conductance of a plate exchanger in parallel, W/K, 0 for none: 0 alone, 3000 in a transfer station.
            Also exchanger_ua_kw_k.
        exchanger_approach_difference_k
            The exchanger heats where the grid is warmer than the return of the house by more than this, K; it
            cools where the grid is colder by more than this. Default: 2.0.
        aux_rated_w
            Rated power of the electric rod behind both, W, 0 for none: 0 alone, 6000 in a transfer station.
            Also aux_rated_kw, aux_rated_mw.
        aux_steps
            Steps of the rod; 0 for any power. Default: 0.
        idle_w
            Electricity while the unit is off, W. Default: 15.0. Also idle_kw, idle_mw.
        heat_share
            Share of the electricity of the compressor that becomes heat of the refrigerant; the rest warms the
            room. Default: 0.95.
        dynamics
            false: the steady map at once, without start, speed limit, pump overrun and least times. Default:
            True.
        """
    def brine_heat_pump(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        aux_modulation: float | None = None,
        enable: float | None = None,
        map: str | _Map | None = None,
        heat_nominal_w: float | None = None,
        heat_nominal_kw: float | None = None,
        heat_nominal_mw: float | None = None,
        cop_nominal: float | None = None,
        source: Literal["boreholes", "pipes", "given"] | None = None,
        ground_k: float | None = None,
        ground_degc: float | None = None,
        length_m: float | None = None,
        length_mm: float | None = None,
        length_cm: float | None = None,
        length_km: float | None = None,
        radius_m: float | None = None,
        radius_mm: float | None = None,
        radius_cm: float | None = None,
        radius_km: float | None = None,
        wall_resistance_k_m_w: float | None = None,
        spacing_m: float | None = None,
        spacing_mm: float | None = None,
        spacing_cm: float | None = None,
        spacing_km: float | None = None,
        depth_m: float | None = None,
        depth_mm: float | None = None,
        depth_cm: float | None = None,
        depth_km: float | None = None,
        conductivity_w_m_k: float | None = None,
        capacity_j_m3_k: float | None = None,
        capacity_j_m3_degc: float | None = None,
        brine_difference_k: float | None = None,
        source_min_k: float | None = None,
        source_min_degc: float | None = None,
        flow_control: Literal["constant_temperature_difference", "constant_flow"] | None = None,
        temperature_difference_k: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
        return_min_k: float | None = None,
        return_min_degc: float | None = None,
        return_max_k: float | None = None,
        return_max_degc: float | None = None,
        restart_difference_k: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        run_min_s: float | None = None,
        run_min_min: float | None = None,
        run_min_h: float | None = None,
        run_min_d: float | None = None,
        off_min_s: float | None = None,
        off_min_min: float | None = None,
        off_min_h: float | None = None,
        off_min_d: float | None = None,
        start_s: float | None = None,
        start_min: float | None = None,
        start_h: float | None = None,
        start_d: float | None = None,
        pump_overrun_s: float | None = None,
        pump_overrun_min: float | None = None,
        pump_overrun_h: float | None = None,
        pump_overrun_d: float | None = None,
        aux_rated_w: float | None = None,
        aux_rated_kw: float | None = None,
        aux_rated_mw: float | None = None,
        aux_steps: int | None = None,
        idle_w: float | None = None,
        idle_kw: float | None = None,
        idle_mw: float | None = None,
        heat_share: float | None = None,
        dynamics: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "brine_heat_pump".

        A brine heat pump as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Above 0 the unit runs, while nothing drives it. Default: 0.0.
        aux_modulation
            Wanted power of the electric heater as a share of its rated one while nothing drives it. Default:
            0.0.
        enable
            1 releases the unit, 0 keeps it off, while nothing drives it. Default: 1.0.
        map
            Map of heating; the reference unit where none is given.
        heat_nominal_w
            Heat of the reference unit at brine of 0 and water of 35 degC, W: its size. Default: 10800.0. Also
            heat_nominal_kw, heat_nominal_mw.
        cop_nominal
            COP of the reference unit there. Default: 4.7.
        source
            What it takes its heat from. One of boreholes, pipes, given. Default: boreholes.
        ground_k
            Undisturbed ground, or the brine itself, while nothing drives it, K; with `pipes` and `given` it
            follows the ground of the weather. Default: 283.15. Also ground_degc.
        length_m
            Length of all boreholes or pipes, m. Default: 200.0. Also length_mm, length_cm, length_km.
        radius_m
            Radius of a borehole, or of a pipe, m; 0.075 and 0.016 where it is not given. Also radius_mm,
            radius_cm, radius_km.
        wall_resistance_k_m_w
            Resistance from the brine to the wall of the hole or pipe, K m/W. Default: 0.1.
        spacing_m
            Distance between pipes, m. Default: 0.6. Also spacing_mm, spacing_cm, spacing_km.
        depth_m
            Depth of pipes, m. Default: 1.5. Also depth_mm, depth_cm, depth_km.
        conductivity_w_m_k
            Conductivity of the ground, W/(m K). Default: 2.0.
        capacity_j_m3_k
            Heat capacity of the ground, J/(m3 K). Default: 2200000.0. Also capacity_j_m3_degc.
        brine_difference_k
            By how much the ground warms the brine, K. Default: 5.0.
        source_min_k
            The unit stops where the brine arrives colder, K. Default: 268.15. Also source_min_degc.
        flow_control
            How the flow of the water is set. One of constant_temperature_difference, constant_flow. Default:
            constant_temperature_difference.
        temperature_difference_k
            Difference of supply and return with `constant_temperature_difference`, K. Default: 5.0.
        v_flow_m3_s
            Flow with `constant_flow`, m3/s. Default: 0.0005. Also v_flow_l_s, v_flow_l_min, v_flow_l_h,
            v_flow_m3_h.
        return_min_k
            The unit stops where the water arrives colder, K. Default: 293.15. Also return_min_degc.
        return_max_k
            The unit stops where the water arrives warmer, K. Default: 341.15. Also return_max_degc.
        restart_difference_k
            How far inside its limits the temperature must be to start again, K. Default: 2.0.
        supply_max_k
            High-pressure cut-out: water that leaves the condenser warmer stops the unit, K. Default: 343.15.
            Also supply_max_degc.
        run_min_s
            Smallest time of a run, s. Default: 300.0. Also run_min_min, run_min_h, run_min_d.
        off_min_s
            Smallest time between a stop and the next start, s. Default: 300.0. Also off_min_min, off_min_h,
            off_min_d.
        start_s
            Length of a start, s. Default: 300.0. Also start_min, start_h, start_d.
        pump_overrun_s
            How long the pump runs after the command to stop, s. Default: 80.0. Also pump_overrun_min,
            pump_overrun_h, pump_overrun_d.
        aux_rated_w
            Rated power of the electric heater behind the condenser, W; 0 for none. Default: 6000.0. Also
            aux_rated_kw, aux_rated_mw.
        aux_steps
            Steps of the electric heater; 0 for any power. Default: 3.
        idle_w
            Electricity while the unit is off, W. Default: 15.0. Also idle_kw, idle_mw.
        heat_share
            Share of the electricity of the compressor that becomes heat of the refrigerant; the rest warms the
            room. Default: 0.95.
        dynamics
            false: the steady map at once, without start, pump overrun, least times and content. Default: True.
        """
    def direct_exchanger(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        mode: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        approach_difference_k: float | None = None,
        house_v_flow_m3_s: float | None = None,
        house_v_flow_l_s: float | None = None,
        house_v_flow_l_min: float | None = None,
        house_v_flow_l_h: float | None = None,
        house_v_flow_m3_h: float | None = None,
        house_flow: Literal["own", "given"] | None = None,
        grid_flow_control: Literal["constant_temperature_difference", "constant_flow"] | None = None,
        grid_temperature_difference_k: float | None = None,
        grid_v_flow_min_m3_s: float | None = None,
        grid_v_flow_min_l_s: float | None = None,
        grid_v_flow_min_l_min: float | None = None,
        grid_v_flow_min_l_h: float | None = None,
        grid_v_flow_min_m3_h: float | None = None,
        grid_v_flow_max_m3_s: float | None = None,
        grid_v_flow_max_l_s: float | None = None,
        grid_v_flow_max_l_min: float | None = None,
        grid_v_flow_max_l_h: float | None = None,
        grid_v_flow_max_m3_h: float | None = None,
        grid_v_flow_m3_s: float | None = None,
        grid_v_flow_l_s: float | None = None,
        grid_v_flow_l_min: float | None = None,
        grid_v_flow_l_h: float | None = None,
        grid_v_flow_m3_h: float | None = None,
        reversed_for_cold: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "direct_exchanger".

        A direct exchanger as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Share of the full flows while nothing drives it; 0 is off. Default: 0.0.
        mode
            0 heating, 1 cooling, while nothing drives it. Default: 1.0.
        ua_w_k
            Conductance, W/K. Default: 3000.0. Also ua_kw_k.
        approach_difference_k
            It works where grid and return of the house differ by more than this in the right sense, K.
            Default: 2.0.
        house_v_flow_m3_s
            Full flow of the house, m3/s. Default: 0.0005. Also house_v_flow_l_s, house_v_flow_l_min,
            house_v_flow_l_h, house_v_flow_m3_h.
        house_flow
            Whether the house side has its own pump, or takes the flow of its circuit. One of own, given.
            Default: own.
        grid_flow_control
            How the flow of the grid is set. One of constant_temperature_difference, constant_flow. Default:
            constant_temperature_difference.
        grid_temperature_difference_k
            Change of the grid water with `constant_temperature_difference`, K. Default: 5.0.
        grid_v_flow_min_m3_s
            Smallest flow of the grid with `constant_temperature_difference`, m3/s. Default:
            3.3333333333333335e-05. Also grid_v_flow_min_l_s, grid_v_flow_min_l_min, grid_v_flow_min_l_h,
            grid_v_flow_min_m3_h.
        grid_v_flow_max_m3_s
            Largest flow of the grid with `constant_temperature_difference`, m3/s. Default:
            0.0004166666666666667. Also grid_v_flow_max_l_s, grid_v_flow_max_l_min, grid_v_flow_max_l_h,
            grid_v_flow_max_m3_h.
        grid_v_flow_m3_s
            Full flow of the grid with `constant_flow`, m3/s. Default: 0.0002. Also grid_v_flow_l_s,
            grid_v_flow_l_min, grid_v_flow_l_h, grid_v_flow_m3_h.
        reversed_for_cold
            Whether the grid water flows from the cold to the hot line while the house is cooled. Default:
            True.
        """
    def balancing_exchanger(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        flow_ratio: float | None = None,
        storage_v_flow_max_m3_s: float | None = None,
        storage_v_flow_max_l_s: float | None = None,
        storage_v_flow_max_l_min: float | None = None,
        storage_v_flow_max_l_h: float | None = None,
        storage_v_flow_max_m3_h: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "balancing_exchanger".

        An exchanger of a balancing unit as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        ua_w_k
            Conductance, W/K. Default: 6000.0. Also ua_kw_k.
        flow_ratio
            Flow of the storage side over that of the grid. Default: 1.0.
        storage_v_flow_max_m3_s
            Largest flow of the storage side, m3/s. Default: 0.001. Also storage_v_flow_max_l_s,
            storage_v_flow_max_l_min, storage_v_flow_max_l_h, storage_v_flow_max_m3_h.
        """
    def condensing_boiler(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        enable: float | None = None,
        supply_set_k: float | None = None,
        supply_set_degc: float | None = None,
        nominal_w: float | None = None,
        nominal_kw: float | None = None,
        nominal_mw: float | None = None,
        modulation_min: float | None = None,
        load_change_s: float | None = None,
        load_change_min: float | None = None,
        load_change_h: float | None = None,
        load_change_d: float | None = None,
        command: Literal["power", "supply_temperature"] | None = None,
        flow_control: Literal["constant_temperature_difference", "measured_temperature_difference", "constant_flow", "constant_supply"] | None = None,
        temperature_difference_k: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        table_return_k: Sequence[float] | None = None,
        table_return_degc: Sequence[float] | None = None,
        table_efficiency: Sequence[float] | None = None,
        table_heat_min_w: Sequence[float] | None = None,
        table_heat_min_kw: Sequence[float] | None = None,
        table_heat_min_mw: Sequence[float] | None = None,
        table_heat_max_w: Sequence[float] | None = None,
        table_heat_max_kw: Sequence[float] | None = None,
        table_heat_max_mw: Sequence[float] | None = None,
        return_max_k: float | None = None,
        return_max_degc: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        restart_difference_k: float | None = None,
        run_min_s: float | None = None,
        run_min_min: float | None = None,
        run_min_h: float | None = None,
        run_min_d: float | None = None,
        off_min_s: float | None = None,
        off_min_min: float | None = None,
        off_min_h: float | None = None,
        off_min_d: float | None = None,
        start_times_s: Sequence[float] | None = None,
        start_times_min: Sequence[float] | None = None,
        start_times_h: Sequence[float] | None = None,
        start_times_d: Sequence[float] | None = None,
        start_heat: Sequence[float] | None = None,
        start_flow: Sequence[float] | None = None,
        stop_times_s: Sequence[float] | None = None,
        stop_times_min: Sequence[float] | None = None,
        stop_times_h: Sequence[float] | None = None,
        stop_times_d: Sequence[float] | None = None,
        stop_heat: Sequence[float] | None = None,
        efficiency_factor: float | None = None,
        part_load_factor: Sequence[float] | None = None,
        metal_capacity_j_k: float | None = None,
        metal_capacity_kj_k: float | None = None,
        metal_conductance_w_k: float | None = None,
        metal_conductance_kw_k: float | None = None,
        idle_w: float | None = None,
        idle_kw: float | None = None,
        idle_mw: float | None = None,
        dynamics: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "condensing_boiler".

        A condensing gas boiler as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Wanted load as a share of the full one while nothing drives it; 0 is off. Default: 0.0.
        enable
            1 releases the unit, 0 keeps it off, while nothing drives it. Default: 1.0.
        supply_set_k
            Set supply temperature while nothing drives it, K: with `constant_supply`, or `command =
            "supply_temperature"`. Default: 333.15. Also supply_set_degc.
        nominal_w
            Nominal heat, W: 14, 20 or 50 kW are those of the series; the map of 14 kW is scaled. Default:
            14000.0. Also nominal_kw, nominal_mw.
        modulation_min
            Smallest load as a share of the full one. Default: 0.2.
        load_change_s
            Time in which the load would change from nothing to full, s; 0 at once. Default: 0.0. Also
            load_change_min, load_change_h, load_change_d.
        command
            What the command is. One of power, supply_temperature. Default: power.
        flow_control
            How the flow of the water is set. One of constant_temperature_difference,
            measured_temperature_difference, constant_flow, constant_supply. Default:
            constant_temperature_difference.
        temperature_difference_k
            Difference of supply and return with a constant or measured temperature difference, K. Default:
            20.0.
        v_flow_m3_s
            Flow with `constant_flow`, m3/s. Default: 0.0003333333333333333. Also v_flow_l_s, v_flow_l_min,
            v_flow_l_h, v_flow_m3_h.
        v_flow_max_m3_s
            Largest flow with `constant_supply`, m3/s. Default: 0.0006666666666666666. Also v_flow_max_l_s,
            v_flow_max_l_min, v_flow_max_l_h, v_flow_max_m3_h.
        table_return_k
            Another map: return temperatures, K, rising. Also table_return_degc.
        table_efficiency
            Another map: efficiency by the lower heating value at these temperatures.
        table_heat_min_w
            Another map: heat at the smallest load at these temperatures, W. Also table_heat_min_kw,
            table_heat_min_mw.
        table_heat_max_w
            Another map: heat at full load at these temperatures, W. Also table_heat_max_kw, table_heat_max_mw.
        return_max_k
            The unit stops where the water arrives warmer, K. Default: 348.15. Also return_max_degc.
        supply_max_k
            The unit stops where the water leaves warmer, K. Default: 356.15. Also supply_max_degc.
        restart_difference_k
            How far below its limits the water must be to start again, K. Default: 5.0.
        run_min_s
            Smallest time of a run, s. Default: 0.0. Also run_min_min, run_min_h, run_min_d.
        off_min_s
            Smallest time between a stop and the next start, s. Default: 0.0. Also off_min_min, off_min_h,
            off_min_d.
        start_times_s
            Start: times of its table, s, rising from 0. Default: [0.0, 9.0, 21.0, 33.0, 45.0, 57.0, 69.0,
            93.0, 117.0, 141.0, 165.0, 189.0, 213.0, 237.0, 273.0, 300.0]. Also start_times_min, start_times_h,
            start_times_d.
        start_heat
            Start: heat at these times as a share of the steady one. Default: [0.0, 0.16, 0.49, 0.51, 0.4,
            0.42, 0.54, 0.74, 0.93, 1.07, 1.26, 1.16, 1.11, 1.05, 1.0, 1.0].
        start_flow
            Start: flow at these times as a share of the steady one. Default: [0.0, 0.72, 0.7, 0.67, 0.65,
            0.63, 0.67, 0.79, 0.92, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0].
        stop_times_s
            Stop: times of its table, s, rising from 0. Default: [0.0, 2.0, 3.0, 5.0, 8.0, 10.0, 15.0, 20.0,
            30.0, 70.0]. Also stop_times_min, stop_times_h, stop_times_d.
        stop_heat
            Stop: heat at these times as a share of that before; the flow goes on until the last one. Default:
            [1.0, 1.0, 0.97, 0.79, 0.47, 0.34, 0.17, 0.1, 0.05, 0.0].
        efficiency_factor
            Efficiency over what the map says, at all loads. Default: 1.0.
        part_load_factor
            The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
        metal_capacity_j_k
            Heat capacity of metal that takes part beside what start and stop show, J/K; 0 for none. Default:
            0.0. Also metal_capacity_kj_k.
        metal_conductance_w_k
            Conductance between this metal and the water, W/K. Default: 100.0. Also metal_conductance_kw_k.
        idle_w
            Electricity of control, fan and pump, W. Default: 35.0. Also idle_kw, idle_mw.
        dynamics
            false: the steady map at once, without start, stop, load changes and least times. Default: True.
        """
    def chp(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        enable: float | None = None,
        supply_set_k: float | None = None,
        supply_set_degc: float | None = None,
        size: Literal["2kw", "5kw", "18kw"] | None = None,
        electric_max_w: float | None = None,
        electric_max_kw: float | None = None,
        electric_max_mw: float | None = None,
        modulation_min: float | None = None,
        electric_efficiency: float | None = None,
        electric_efficiency_min: float | None = None,
        total_efficiency: float | None = None,
        load_change_s: float | None = None,
        load_change_min: float | None = None,
        load_change_h: float | None = None,
        load_change_d: float | None = None,
        flow_control: Literal["constant_temperature_difference", "measured_temperature_difference", "constant_flow", "constant_supply"] | None = None,
        temperature_difference_k: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        return_max_k: float | None = None,
        return_max_degc: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        restart_difference_k: float | None = None,
        run_min_s: float | None = None,
        run_min_min: float | None = None,
        run_min_h: float | None = None,
        run_min_d: float | None = None,
        off_min_s: float | None = None,
        off_min_min: float | None = None,
        off_min_h: float | None = None,
        off_min_d: float | None = None,
        start_s: float | None = None,
        start_min: float | None = None,
        start_h: float | None = None,
        start_d: float | None = None,
        warm_start_s: float | None = None,
        warm_start_min: float | None = None,
        warm_start_h: float | None = None,
        warm_start_d: float | None = None,
        cold_after_s: float | None = None,
        cold_after_min: float | None = None,
        cold_after_h: float | None = None,
        cold_after_d: float | None = None,
        warm_up_w: float | None = None,
        warm_up_kw: float | None = None,
        warm_up_mw: float | None = None,
        warm_up_s: float | None = None,
        warm_up_min: float | None = None,
        warm_up_h: float | None = None,
        warm_up_d: float | None = None,
        efficiency_factor: float | None = None,
        part_load_factor: Sequence[float] | None = None,
        idle_w: float | None = None,
        idle_kw: float | None = None,
        idle_mw: float | None = None,
        content_j_k: float | None = None,
        content_kj_k: float | None = None,
        content_loss_w_k: float | None = None,
        content_loss_kw_k: float | None = None,
        ambient_k: float | None = None,
        ambient_degc: float | None = None,
        pump_on_k: float | None = None,
        pump_on_degc: float | None = None,
        pump_off_k: float | None = None,
        pump_off_degc: float | None = None,
        initial_content_k: float | None = None,
        initial_content_degc: float | None = None,
        dynamics: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "chp".

        A gas engine with heat and power as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Wanted electricity as a share of the largest while nothing drives it; 0 is off. Default: 0.0.
        enable
            1 releases the unit, 0 keeps it off, while nothing drives it. Default: 1.0.
        supply_set_k
            Set supply temperature with `constant_supply` while nothing drives it, K. Default: 353.15. Also
            supply_set_degc.
        size
            Size: gives what is not stated below. One of 2kw, 5kw, 18kw. Default: 2kw.
        electric_max_w
            Electricity at full load, W. Also electric_max_kw, electric_max_mw.
        modulation_min
            Smallest load as a share of the full one.
        electric_efficiency
            Electric efficiency at full load.
        electric_efficiency_min
            Electric efficiency at the smallest load; three quarters of that at full load without it.
        total_efficiency
            Efficiency of heat and electricity at full load and a return of 35 degC.
        load_change_s
            Time in which the load would change from nothing to full, s; 0 at once. Default: 40.0. Also
            load_change_min, load_change_h, load_change_d.
        flow_control
            How the flow of the water is set. One of constant_temperature_difference,
            measured_temperature_difference, constant_flow, constant_supply. Default: constant_supply.
        temperature_difference_k
            Difference of supply and return with a constant temperature difference, K. Default: 20.0.
        v_flow_m3_s
            Flow with `constant_flow`, m3/s. Default: 6.666666666666667e-05. Also v_flow_l_s, v_flow_l_min,
            v_flow_l_h, v_flow_m3_h.
        v_flow_max_m3_s
            Largest flow with `constant_supply`, m3/s. Default: 0.0006666666666666666. Also v_flow_max_l_s,
            v_flow_max_l_min, v_flow_max_l_h, v_flow_max_m3_h.
        return_max_k
            The unit stops where the water arrives warmer, K. Default: 348.15. Also return_max_degc.
        supply_max_k
            The unit stops where the water leaves warmer, K. Default: 366.15. Also supply_max_degc.
        restart_difference_k
            How far below its limits the water must be to start again, K. Default: 5.0.
        run_min_s
            Smallest time of a run, s. Default: 0.0. Also run_min_min, run_min_h, run_min_d.
        off_min_s
            Smallest time between a stop and the next start, s. Default: 0.0. Also off_min_min, off_min_h,
            off_min_d.
        start_s
            Length of a start of the cold engine, s; no heat in its first 88 %. Default: 825.0. Also start_min,
            start_h, start_d.
        warm_start_s
            Length of a start of the warm engine, s. Default: 200.0. Also warm_start_min, warm_start_h,
            warm_start_d.
        cold_after_s
            Standstill after which the engine is cold, s. Default: 36000.0. Also cold_after_min, cold_after_h,
            cold_after_d.
        warm_up_w
            Heat that the cold engine takes for itself when it starts, W per 1.9 kW of electricity; it ends in
            `warm_up_s`. 1000 W without this; nothing with a content, which takes that heat itself: what is
            given counts besides. Also warm_up_kw, warm_up_mw.
        warm_up_s
            Time in which the engine warms up, s. Default: 2400.0. Also warm_up_min, warm_up_h, warm_up_d.
        efficiency_factor
            Efficiency over what the map says, at all loads. Default: 1.0.
        part_load_factor
            The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
        idle_w
            Electricity while the unit is off, W. Default: 35.0. Also idle_kw, idle_mw.
        content_j_k
            Heat capacity of the engine with its water, J/K: 60 kJ/K; 0 (default) for the measured start
            without a content. Default: 0.0. Also content_kj_k.
        content_loss_w_k
            Heat of that content to its surroundings, W/K. Default: 5.0. Also content_loss_kw_k.
        ambient_k
            Temperature around the engine, K. Default: 291.15. Also ambient_degc.
        pump_on_k
            The pump starts where the content is hotter, K. Default: 355.15. Also pump_on_degc.
        pump_off_k
            The pump stops where the content is colder, K. Default: 348.15. Also pump_off_degc.
        initial_content_k
            Temperature of the content at the start of the run, K; that of the run without it. Also
            initial_content_degc.
        dynamics
            false: the steady map at once, without start, warm-up, stop, load changes and least times. Default:
            True.
        """
    def stirling_chp(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        modulation: float | None = None,
        aux_modulation: float | None = None,
        rod_modulation: float | None = None,
        enable: float | None = None,
        supply_set_k: float | None = None,
        supply_set_degc: float | None = None,
        electric_max_w: float | None = None,
        electric_max_kw: float | None = None,
        electric_max_mw: float | None = None,
        electric_efficiency: float | None = None,
        total_efficiency: float | None = None,
        aux_nominal_w: float | None = None,
        aux_nominal_kw: float | None = None,
        aux_nominal_mw: float | None = None,
        rod_rated_w: float | None = None,
        rod_rated_kw: float | None = None,
        rod_rated_mw: float | None = None,
        flow_control: Literal["constant_temperature_difference", "measured_temperature_difference", "constant_flow", "constant_supply"] | None = None,
        temperature_difference_k: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        return_max_k: float | None = None,
        return_max_degc: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        restart_difference_k: float | None = None,
        run_min_s: float | None = None,
        run_min_min: float | None = None,
        run_min_h: float | None = None,
        run_min_d: float | None = None,
        off_min_s: float | None = None,
        off_min_min: float | None = None,
        off_min_h: float | None = None,
        off_min_d: float | None = None,
        efficiency_factor: float | None = None,
        part_load_factor: Sequence[float] | None = None,
        idle_w: float | None = None,
        idle_kw: float | None = None,
        idle_mw: float | None = None,
        dynamics: bool | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "stirling_chp".

        A Stirling engine with an auxiliary boiler and an electric rod, in one unit with one circuit.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        modulation
            Above 0 the engine runs, at full load, while nothing drives it. Default: 0.0.
        aux_modulation
            Wanted load of the auxiliary boiler while nothing drives it; 0 is off. Default: 0.0.
        rod_modulation
            Wanted power of the rod as a share of its rated one while nothing drives it. Default: 0.0.
        enable
            1 releases the unit, 0 keeps it off, while nothing drives it. Default: 1.0.
        supply_set_k
            Set supply temperature with `constant_supply` while nothing drives it, K. Default: 333.15. Also
            supply_set_degc.
        electric_max_w
            Electricity of the engine, W. Default: 1000.0. Also electric_max_kw, electric_max_mw.
        electric_efficiency
            Electric efficiency of the engine. Default: 0.13.
        total_efficiency
            Efficiency of its heat and electricity at a return of 30 degC; 0.2 % less per kelvin above.
            Default: 0.93.
        aux_nominal_w
            Nominal heat of the auxiliary boiler, W: that of a `condensing_boiler`. Default: 20000.0. Also
            aux_nominal_kw, aux_nominal_mw.
        rod_rated_w
            Rated power of the rod, W; 0 for none. Default: 6000.0. Also rod_rated_kw, rod_rated_mw.
        flow_control
            How the flow of the water is set. One of constant_temperature_difference,
            measured_temperature_difference, constant_flow, constant_supply. Default:
            constant_temperature_difference.
        temperature_difference_k
            Difference of supply and return with a constant temperature difference, K. Default: 20.0.
        v_flow_m3_s
            Flow with `constant_flow`, m3/s. Default: 0.00016666666666666666. Also v_flow_l_s, v_flow_l_min,
            v_flow_l_h, v_flow_m3_h.
        v_flow_max_m3_s
            Largest flow with `constant_supply`, m3/s. Default: 0.0006666666666666666. Also v_flow_max_l_s,
            v_flow_max_l_min, v_flow_max_l_h, v_flow_max_m3_h.
        return_max_k
            The unit stops where the water arrives warmer, K. Default: 348.15. Also return_max_degc.
        supply_max_k
            The unit stops where the water leaves warmer, K. Default: 366.15. Also supply_max_degc.
        restart_difference_k
            How far below its limits the water must be to start again, K. Default: 5.0.
        run_min_s
            Smallest time of a run of the engine, s. Default: 0.0. Also run_min_min, run_min_h, run_min_d.
        off_min_s
            Smallest time between a stop and the next start of the engine, s. Default: 0.0. Also off_min_min,
            off_min_h, off_min_d.
        efficiency_factor
            Efficiency over what the map says, at all loads. Default: 1.0.
        part_load_factor
            The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
        idle_w
            Electricity while the unit is off, W. Default: 35.0. Also idle_kw, idle_mw.
        dynamics
            false: the steady maps at once, without start, stop and least times. Default: True.
        """
    def domestic_hot_water(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        heated_by: Literal["exchanger", "passing"] | None = None,
        daily_m3: float | None = None,
        daily_l: float | None = None,
        seed: int | None = None,
        weekend_factor: float | None = None,
        season_amplitude: float | None = None,
        utc_offset_s: float | None = None,
        utc_offset_min: float | None = None,
        utc_offset_h: float | None = None,
        utc_offset_d: float | None = None,
        tap_set_k: float | None = None,
        tap_set_degc: float | None = None,
        tolerance_difference_k: float | None = None,
        cold_k: float | None = None,
        cold_degc: float | None = None,
        cold_amplitude_difference_k: float | None = None,
        missing: Literal["logged", "postponed"] | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        pump_w: float | None = None,
        pump_kw: float | None = None,
        pump_mw: float | None = None,
        circulation: float | None = None,
        circulation_loss_w: float | None = None,
        circulation_loss_kw: float | None = None,
        circulation_loss_mw: float | None = None,
        circulation_pump_w: float | None = None,
        circulation_pump_kw: float | None = None,
        circulation_pump_mw: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "domestic_hot_water".

        Hot water of a house as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        heated_by
            What heats the water of the taps. One of exchanger, passing. Default: exchanger.
        daily_m3
            Mean volume of a day at the set temperature, m3; without it the signal `v_flow_m3_s` drives the
            draws. Also daily_l.
        seed
            Number that chooses the sequence of draws, with the name of the unit. Default: 1.
        weekend_factor
            Volume of a day at the weekend over that of a workday. Default: 1.2.
        season_amplitude
            How much more is drawn in February than on average, relative. Default: 0.1.
        utc_offset_s
            Local clock over UTC, s. Default: 3600.0. Also utc_offset_min, utc_offset_h, utc_offset_d.
        tap_set_k
            Set temperature of the taps while nothing drives it, K. Default: 318.15. Also tap_set_degc.
        tolerance_difference_k
            A tap may be colder by this without discomfort, K. Default: 1.0.
        cold_k
            Mean temperature of the cold water over the year, K. Default: 283.15. Also cold_degc.
        cold_amplitude_difference_k
            How much warmer the cold water is in August than on average, K. Default: 3.0.
        missing
            What becomes of heat that is missing. One of logged, postponed. Default: logged.
        ua_w_k
            Conductance of the exchanger, W/K. Default: 6000.0. Also ua_kw_k.
        v_flow_max_m3_s
            Largest flow of the pump on the side of the storage, m3/s. Default: 0.0006666666666666666. Also
            v_flow_max_l_s, v_flow_max_l_min, v_flow_max_l_h, v_flow_max_m3_h.
        pump_w
            Electricity of that pump while water is drawn, W. Default: 40.0. Also pump_kw, pump_mw.
        circulation
            1: the circulation runs, while nothing drives it. Default: 1.0.
        circulation_loss_w
            Heat that the pipes of the circulation lose, W; 0 without circulation. Default: 0.0. Also
            circulation_loss_kw, circulation_loss_mw.
        circulation_pump_w
            Electricity of the pump of the circulation, W. Default: 10.0. Also circulation_pump_kw,
            circulation_pump_mw.
        """
    def solar_collector(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        collector: Literal["flat_plate", "cpc"] | None = None,
        area_m2: float | None = None,
        area_cm2: float | None = None,
        eta0: float | None = None,
        a1_w_m2_k: float | None = None,
        a2: float | None = None,
        b0: float | None = None,
        k_diffuse: float | None = None,
        capacity_j_m2_k: float | None = None,
        capacity_j_m2_degc: float | None = None,
        tilt_rad: float | None = None,
        tilt_deg: float | None = None,
        azimuth_rad: float | None = None,
        azimuth_deg: float | None = None,
        albedo: float | None = None,
        sky: Literal["isotropic", "perez"] | None = None,
        flow_control: Literal["difference", "supply"] | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        start_difference_k: float | None = None,
        stop_difference_k: float | None = None,
        flow_from_difference_k: float | None = None,
        flow_full_difference_k: float | None = None,
        supply_set_k: float | None = None,
        supply_set_degc: float | None = None,
        supply_high_k: float | None = None,
        supply_high_degc: float | None = None,
        return_max_k: float | None = None,
        return_max_degc: float | None = None,
        collector_max_k: float | None = None,
        collector_max_degc: float | None = None,
        pump_w: float | None = None,
        pump_kw: float | None = None,
        pump_mw: float | None = None,
        enable: float | None = None,
        t_outdoor_k: float | None = None,
        t_outdoor_degc: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "solar_collector".

        Solar thermal collectors as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        collector
            Which collectors: gives the coefficients that are not stated. One of flat_plate, cpc. Default:
            flat_plate.
        area_m2
            Area of the collectors, m2. Default: 12.0. Also area_cm2.
        eta0
            Efficiency without losses.
        a1_w_m2_k
            Linear loss, W/(m2 K).
        a2
            Quadratic loss, W/(m2 K2).
        b0
            Change of the efficiency with the angle of incidence of the beam.
        k_diffuse
            Efficiency for diffuse irradiance over that of beam at a right angle. Default: 0.9.
        capacity_j_m2_k
            Heat capacity with content, J/(m2 K). Default: 7000.0. Also capacity_j_m2_degc.
        tilt_rad
            Tilt from the horizontal, rad. Default: 0.6108652381980153. Also tilt_deg.
        azimuth_rad
            Where they look, from south, west positive, rad. Default: 0.0. Also azimuth_deg.
        albedo
            Albedo of the ground before them. Default: 0.2.
        sky
            How the sky shines. One of isotropic, perez. Default: perez.
        flow_control
            How the pump sets its flow. One of difference, supply. Default: difference.
        v_flow_max_m3_s
            Full flow, as water of the same capacity flow, m3/s. Default: 0.0003333333333333333. Also
            v_flow_max_l_s, v_flow_max_l_min, v_flow_max_l_h, v_flow_max_m3_h.
        start_difference_k
            The pump starts where the collector is warmer by more, K. Default: 3.0.
        stop_difference_k
            It stops where the collector is warmer by less, K. Default: 2.0.
        flow_from_difference_k
            With `difference`: above this the flow rises, K. Default: 3.0.
        flow_full_difference_k
            With `difference`: from here on the flow is full, K. Default: 7.0.
        supply_set_k
            With `supply`: the set supply temperature, K. Default: 333.15. Also supply_set_degc.
        supply_high_k
            With `supply`: that where the water comes back warmer than `supply_set_k`, K. Default: 353.15. Also
            supply_high_degc.
        return_max_k
            The pump rests while the water comes back warmer: the storage is full, K. Default: 358.15. Also
            return_max_degc.
        collector_max_k
            The pump does not start while the collector is hotter: it stagnates, K. Default: 368.15. Also
            collector_max_degc.
        pump_w
            Electricity of the pump, W. Default: 40.0. Also pump_kw, pump_mw.
        enable
            1 releases the pump, 0 keeps it off, while nothing drives it. Default: 1.0.
        t_outdoor_k
            Outdoor temperature while neither weather nor anything else drives it, K. Default: 283.15. Also
            t_outdoor_degc.
        """
    def mixing_station(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        set_by: Literal["curve", "signal"] | None = None,
        supply_set_k: float | None = None,
        supply_set_degc: float | None = None,
        nominal_supply_k: float | None = None,
        nominal_supply_degc: float | None = None,
        room_k: float | None = None,
        room_degc: float | None = None,
        design_outdoor_k: float | None = None,
        design_outdoor_degc: float | None = None,
        exponent: float | None = None,
        supply_min_k: float | None = None,
        supply_min_degc: float | None = None,
        supply_max_k: float | None = None,
        supply_max_degc: float | None = None,
        stroke_s: float | None = None,
        stroke_min: float | None = None,
        stroke_h: float | None = None,
        stroke_d: float | None = None,
        pump_w: float | None = None,
        pump_kw: float | None = None,
        pump_mw: float | None = None,
        t_outdoor_k: float | None = None,
        t_outdoor_degc: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "mixing_station".

        A mixing station as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        set_by
            Where the set temperature comes from. One of curve, signal. Default: curve.
        supply_set_k
            Set temperature with `set_by = "signal"` while nothing drives it, K. Default: 313.15. Also
            supply_set_degc.
        nominal_supply_k
            Supply at the design outdoor temperature, K. Default: 333.15. Also nominal_supply_degc.
        room_k
            Room temperature of the curve, K. Default: 294.15. Also room_degc.
        design_outdoor_k
            Outdoor temperature of the design, K. Default: 259.15. Also design_outdoor_degc.
        exponent
            Exponent of the emitters: 1.3 of radiators, 1.1 of floors. Default: 1.3.
        supply_min_k
            The supply is not set colder, K. Default: 293.15. Also supply_min_degc.
        supply_max_k
            The supply is not set warmer, K. Default: 353.15. Also supply_max_degc.
        stroke_s
            Time in which the mixer turns from one end to the other, s; 0 at once. Default: 60.0. Also
            stroke_min, stroke_h, stroke_d.
        pump_w
            Electricity of the pump while water flows, W. Default: 30.0. Also pump_kw, pump_mw.
        t_outdoor_k
            Outdoor temperature while neither weather nor anything else drives it, K. Default: 275.15. Also
            t_outdoor_degc.
        """
    def pv(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        peak_w: float | None = None,
        peak_kw: float | None = None,
        peak_mw: float | None = None,
        tilt_rad: float | None = None,
        tilt_deg: float | None = None,
        azimuth_rad: float | None = None,
        azimuth_deg: float | None = None,
        albedo: float | None = None,
        sky: Literal["isotropic", "perez"] | None = None,
        power_slope: float | None = None,
        noct_k: float | None = None,
        noct_degc: float | None = None,
        system_efficiency: float | None = None,
        inverter_w: float | None = None,
        inverter_kw: float | None = None,
        inverter_mw: float | None = None,
        phase: int | None = None,
        t_outdoor_k: float | None = None,
        t_outdoor_degc: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "pv".

        Photovoltaics as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        peak_w
            Power at 1000 W/m2 and cells of 25 degC, W. Default: 10000.0. Also peak_kw, peak_mw.
        tilt_rad
            Tilt from the horizontal, rad. Default: 0.6108652381980153. Also tilt_deg.
        azimuth_rad
            Where it looks, from south, west positive, rad. Default: 0.0. Also azimuth_deg.
        albedo
            Albedo of the ground before it. Default: 0.2.
        sky
            How the sky shines. One of isotropic, perez. Default: perez.
        power_slope
            Change of the power with the temperature of the cells, 1/K. Default: -0.004.
        noct_k
            Temperature of the cells at 800 W/m2 and air of 20 degC, K. Default: 319.15. Also noct_degc.
        system_efficiency
            Share of the power that cables, inverter, dirt and angles leave. Default: 0.86.
        inverter_w
            Largest power of the inverter, W. Also inverter_kw, inverter_mw.
        phase
            Phase of the grid on which its inverter stands, 1 to 3; three phases alike without this.
        t_outdoor_k
            Outdoor temperature while neither weather nor anything else drives it, K. Default: 283.15. Also
            t_outdoor_degc.
        """
    def battery(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        mode: Literal["power", "grid_power"] | None = None,
        power_w: float | None = None,
        power_kw: float | None = None,
        power_mw: float | None = None,
        grid_set_w: float | None = None,
        grid_set_kw: float | None = None,
        grid_set_mw: float | None = None,
        capacity_j: float | None = None,
        capacity_kwh: float | None = None,
        capacity_mwh: float | None = None,
        charge_max_w: float | None = None,
        charge_max_kw: float | None = None,
        charge_max_mw: float | None = None,
        discharge_max_w: float | None = None,
        discharge_max_kw: float | None = None,
        discharge_max_mw: float | None = None,
        charge_efficiency: float | None = None,
        discharge_efficiency: float | None = None,
        self_discharge_w: float | None = None,
        self_discharge_kw: float | None = None,
        self_discharge_mw: float | None = None,
        soc_min: float | None = None,
        soc_max: float | None = None,
        initial_soc: float | None = None,
        phase: int | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "battery".

        A battery as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        mode
            What it is told. One of power, grid_power. Default: grid_power.
        power_w
            Set power in `power` mode while nothing drives it, W; negative is discharged. Default: 0.0. Also
            power_kw, power_mw.
        grid_set_w
            Set power of house and battery in `grid_power` mode while nothing drives it, W; negative is fed in.
            Default: 0.0. Also grid_set_kw, grid_set_mw.
        capacity_j
            Capacity, J. Default: 36000000.0. Also capacity_kwh, capacity_mwh.
        charge_max_w
            Largest power of charging at the connection, W. Default: 5000.0. Also charge_max_kw, charge_max_mw.
        discharge_max_w
            Largest power of discharging at the connection, W. Default: 5000.0. Also discharge_max_kw,
            discharge_max_mw.
        charge_efficiency
            Efficiency of charging. Default: 0.95.
        discharge_efficiency
            Efficiency of discharging. Default: 0.95.
        self_discharge_w
            What it loses all the time, W. Default: 0.0. Also self_discharge_kw, self_discharge_mw.
        soc_min
            Smallest state of charge to which it is discharged. Default: 0.05.
        soc_max
            Largest state of charge to which it is charged. Default: 1.0.
        initial_soc
            State of charge at the start. Default: 0.5.
        phase
            Phase of the grid on which its inverter stands, 1 to 3; three phases alike without this.
        """
    def household(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        annual_j: float | None = None,
        annual_kwh: float | None = None,
        annual_mwh: float | None = None,
        inhabitants: int | None = None,
        seed: int | None = None,
        base_share: float | None = None,
        season_amplitude: float | None = None,
        workday_absence: float | None = None,
        weekend_absence: float | None = None,
        gain_share: float | None = None,
        phases: Literal["even", "random"] | None = None,
        utc_offset_s: float | None = None,
        utc_offset_min: float | None = None,
        utc_offset_h: float | None = None,
        utc_offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "household".

        The people of a house as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        annual_j
            Electricity in a year, J. Default: 25200000000.0. Also annual_kwh, annual_mwh.
        inhabitants
            People who live there. Default: 6.
        seed
            Number that chooses the sequence of everything random, with the name of the unit. Default: 1.
        base_share
            Share of the electricity that is always drawn. Default: 0.3.
        season_amplitude
            How much more is drawn on the darkest day than on average, relative. Default: 0.15.
        workday_absence
            Probability with which a person is out on a workday. Default: 0.7.
        weekend_absence
            The same of a day at the weekend. Default: 0.4.
        gain_share
            Share of the electricity that heats the rooms, output `appliances_w`. 0: the building counts it
            with its people. Default: 0.0.
        phases
            How the electricity is spread over the three phases of the grid. One of even, random. Default:
            even.
        utc_offset_s
            Local clock over UTC, s. Default: 3600.0. Also utc_offset_min, utc_offset_h, utc_offset_d.
        """
    def electric_load(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        power_w: float | None = None,
        power_kw: float | None = None,
        power_mw: float | None = None,
        phase: int | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "electric_load".

        An electric load as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        power_w
            Power while nothing drives it, W. Default: 0.0. Also power_kw, power_mw.
        phase
            Phase of the grid on which it stands, 1 to 3; three phases alike without this.
        """
    def electric_vehicle(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        charging_w: float | None = None,
        charging_kw: float | None = None,
        charging_mw: float | None = None,
        phase: int | None = None,
        daily_j: float | None = None,
        daily_kwh: float | None = None,
        daily_mwh: float | None = None,
        arrival_s: float | None = None,
        arrival_min: float | None = None,
        arrival_h: float | None = None,
        arrival_d: float | None = None,
        arrival_deviation_s: float | None = None,
        arrival_deviation_min: float | None = None,
        arrival_deviation_h: float | None = None,
        arrival_deviation_d: float | None = None,
        seed: int | None = None,
        utc_offset_s: float | None = None,
        utc_offset_min: float | None = None,
        utc_offset_h: float | None = None,
        utc_offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "electric_vehicle".

        An electric car at its wall box as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        charging_w
            Power while it charges, W. Default: 11000.0. Also charging_kw, charging_mw.
        phase
            Phase of the grid on which it charges, 1 to 3; three phases alike without this.
        daily_j
            Energy of a day, J. Default: 28800000.0. Also daily_kwh, daily_mwh.
        arrival_s
            Mean time of day at which charging begins, s. Default: 64800.0. Also arrival_min, arrival_h,
            arrival_d.
        arrival_deviation_s
            Standard deviation of that time, s. Default: 3600.0. Also arrival_deviation_min,
            arrival_deviation_h, arrival_deviation_d.
        seed
            Number that chooses the sequence of arrivals, with the name of the unit. Default: 1.
        utc_offset_s
            Local clock over UTC, s. Default: 3600.0. Also utc_offset_min, utc_offset_h, utc_offset_d.
        """
    def grid_connection(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        asymmetry_max_w: float | None = None,
        asymmetry_max_kw: float | None = None,
        asymmetry_max_mw: float | None = None,
        import_price_eur_j: float | None = None,
        import_price_eur_kwh: float | None = None,
        import_price_ct_kwh: float | None = None,
        import_price_eur_mwh: float | None = None,
        export_price_eur_j: float | None = None,
        export_price_eur_kwh: float | None = None,
        export_price_ct_kwh: float | None = None,
        export_price_eur_mwh: float | None = None,
        chp_bonus_eur_j: float | None = None,
        chp_bonus_eur_kwh: float | None = None,
        chp_bonus_ct_kwh: float | None = None,
        chp_bonus_eur_mwh: float | None = None,
        power_factor: Mapping[str, float] | None = None,
        fuel_price_eur_j: float | None = None,
        fuel_price_eur_kwh: float | None = None,
        fuel_price_ct_kwh: float | None = None,
        fuel_price_eur_mwh: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "grid_connection".

        The electric connection of a house as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        asymmetry_max_w
            Largest difference of two phases that is no event, W. Default: 4600.0. Also asymmetry_max_kw,
            asymmetry_max_mw.
        import_price_eur_j
            Price of what is drawn while nothing drives it, EUR/J. Default: 0.0. Also import_price_eur_kwh,
            import_price_ct_kwh, import_price_eur_mwh.
        export_price_eur_j
            Price of what is fed in while nothing drives it, EUR/J. Default: 0.0. Also export_price_eur_kwh,
            export_price_ct_kwh, export_price_eur_mwh.
        chp_bonus_eur_j
            What is paid besides for what is fed in of electricity from fuel, EUR/J. Default: 0.0. Also
            chp_bonus_eur_kwh, chp_bonus_ct_kwh, chp_bonus_eur_mwh.
        power_factor
            Power factor `cos phi` of units of the site by their names, and of its pumps as `pumps`; negative
            where they lead (capacitive). Others have 1.
        fuel_price_eur_j
            Price of the fuel of the site while nothing drives it, EUR/J; by the heating value of the units'
            efficiencies. Default: 0.0. Also fuel_price_eur_kwh, fuel_price_ct_kwh, fuel_price_eur_mwh.
        """
    def ideal_house(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        sent_k: float | None = None,
        sent_degc: float | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
        time_constant_s: float | None = None,
        time_constant_min: float | None = None,
        time_constant_h: float | None = None,
        time_constant_d: float | None = None,
        rise_time_s: float | None = None,
        rise_time_min: float | None = None,
        rise_time_h: float | None = None,
        rise_time_d: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "ideal_house".

        An ideal house as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        sent_k
            Temperature of the water the house sends, K: hot while it feeds in, its return while it extracts.
            Also sent_degc.
        v_flow_m3_s
            Flow of its circulation while nothing drives it, m3/s: positive feeds in, negative extracts.
            Default: 0.0. Also v_flow_l_s, v_flow_l_min, v_flow_l_h, v_flow_m3_h.
        time_constant_s
            Time constant of the temperature of the water it sends, s. Default: 10.0. Also time_constant_min,
            time_constant_h, time_constant_d.
        rise_time_s
            Time in which the circulation follows a step by 99.6 %, s. Default: 8.0. Also rise_time_min,
            rise_time_h, rise_time_d.
        """
    def cooling_load(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        load_w: float | None = None,
        load_kw: float | None = None,
        load_mw: float | None = None,
        load_max_w: float | None = None,
        load_max_kw: float | None = None,
        load_max_mw: float | None = None,
        return_k: float | None = None,
        return_degc: float | None = None,
        temperature_difference_k: float | None = None,
        v_flow_min_m3_s: float | None = None,
        v_flow_min_l_s: float | None = None,
        v_flow_min_l_min: float | None = None,
        v_flow_min_l_h: float | None = None,
        v_flow_min_m3_h: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        warmest_return_k: float | None = None,
        warmest_return_degc: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "cooling_load".

        A cooling load as written in a model file: with `return_k` or `temperature_difference_k`.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        load_w
            Cooling demand while no series drives it, W. Default: 0.0. Also load_kw, load_mw.
        load_max_w
            The largest power that an emulated load can take, W; what is demanded beyond is `unmet_w`. Absent:
            no limit. Also load_max_kw, load_max_mw.
        return_k
            Temperature of the returned water, K. Also return_degc.
        temperature_difference_k
            Difference of returned and supplied water, K.
        v_flow_min_m3_s
            By-pass: the smallest flow, m3/s. Default: 0.0. Also v_flow_min_l_s, v_flow_min_l_min,
            v_flow_min_l_h, v_flow_min_m3_h.
        v_flow_max_m3_s
            The largest flow, m3/s. Default: 0.001. Also v_flow_max_l_s, v_flow_max_l_min, v_flow_max_l_h,
            v_flow_max_m3_h.
        warmest_return_k
            The water is not warmed above this, K. Default: 298.15. Also warmest_return_degc.
        """
    def building(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        living_area_m2: float | None = None,
        living_area_cm2: float | None = None,
        floors: float | None = None,
        clear_height_m: float | None = None,
        clear_height_mm: float | None = None,
        clear_height_cm: float | None = None,
        clear_height_km: float | None = None,
        construction: Literal["until_1978", "until_1994", "until_2001", "enev_2007", "enev_2016"] | None = None,
        layout: Literal["compact", "elongated"] | None = None,
        attached_buildings: int | None = None,
        window_share: float | None = None,
        window_g: float | None = None,
        window_shading: float | None = None,
        dormers: bool | None = None,
        azimuth_rad: float | None = None,
        azimuth_deg: float | None = None,
        wall_insulation_m: float | None = None,
        wall_insulation_mm: float | None = None,
        wall_insulation_cm: float | None = None,
        wall_insulation_km: float | None = None,
        wall_insulated_share: float | None = None,
        ceiling_insulation_m: float | None = None,
        ceiling_insulation_mm: float | None = None,
        ceiling_insulation_cm: float | None = None,
        ceiling_insulation_km: float | None = None,
        ceiling_insulated_share: float | None = None,
        floor_insulation_m: float | None = None,
        floor_insulation_mm: float | None = None,
        floor_insulation_cm: float | None = None,
        floor_insulation_km: float | None = None,
        wall_w_m2_k: float | None = None,
        ceiling_w_m2_k: float | None = None,
        floor_w_m2_k: float | None = None,
        window_w_m2_k: float | None = None,
        air_j_m2_k: float | None = None,
        air_j_m2_degc: float | None = None,
        inner_j_m2_k: float | None = None,
        inner_j_m2_degc: float | None = None,
        air_change_absent_1_s: float | None = None,
        air_change_absent_1_h: float | None = None,
        air_change_present_1_s: float | None = None,
        air_change_present_1_h: float | None = None,
        inhabitants: float | None = None,
        person_w: float | None = None,
        person_kw: float | None = None,
        person_mw: float | None = None,
        emitter: Literal["radiator", "floor"] | None = None,
        heating_w_m2: float | None = None,
        nominal_supply_k: float | None = None,
        nominal_supply_degc: float | None = None,
        nominal_return_k: float | None = None,
        nominal_return_degc: float | None = None,
        nominal_room_k: float | None = None,
        nominal_room_degc: float | None = None,
        emitter_exponent: float | None = None,
        emitter_capacity_j_k: float | None = None,
        emitter_capacity_kj_k: float | None = None,
        heating: bool | None = None,
        cooling: bool | None = None,
        cooling_w_m2_k: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        room_set_k: float | None = None,
        room_set_degc: float | None = None,
        cooling_set_k: float | None = None,
        cooling_set_degc: float | None = None,
        thermostat_difference_k: float | None = None,
        thermostat_reset_s: float | None = None,
        thermostat_reset_min: float | None = None,
        thermostat_reset_h: float | None = None,
        thermostat_reset_d: float | None = None,
        night_set_k: float | None = None,
        night_set_degc: float | None = None,
        night_from_s: float | None = None,
        night_from_min: float | None = None,
        night_from_h: float | None = None,
        night_from_d: float | None = None,
        night_until_s: float | None = None,
        night_until_min: float | None = None,
        night_until_h: float | None = None,
        night_until_d: float | None = None,
        night_off_from_s: float | None = None,
        night_off_from_min: float | None = None,
        night_off_from_h: float | None = None,
        night_off_from_d: float | None = None,
        night_off_until_s: float | None = None,
        night_off_until_min: float | None = None,
        night_off_until_h: float | None = None,
        night_off_until_d: float | None = None,
        holidays: Sequence[str] | None = None,
        utc_offset_s: float | None = None,
        utc_offset_min: float | None = None,
        utc_offset_h: float | None = None,
        utc_offset_d: float | None = None,
        start_time_s: float | None = None,
        start_time_min: float | None = None,
        start_time_h: float | None = None,
        start_time_d: float | None = None,
        absent_set_k: float | None = None,
        absent_set_degc: float | None = None,
        heating_limit_k: float | None = None,
        heating_limit_degc: float | None = None,
        initial_living_k: float | None = None,
        initial_living_degc: float | None = None,
        initial_roof_k: float | None = None,
        initial_roof_degc: float | None = None,
        initial_cellar_k: float | None = None,
        initial_cellar_degc: float | None = None,
        outdoor_k: float | None = None,
        outdoor_degc: float | None = None,
        ground_k: float | None = None,
        ground_degc: float | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "building".

        A house of three zones with its heat emission and thermostats.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        living_area_m2
            Heated area, m2. Default: 300.0. Also living_area_cm2.
        floors
            Heated floors; 1.5 for half an attic. Default: 2.0.
        clear_height_m
            Clear height of a floor, m. Default: 2.6. Also clear_height_mm, clear_height_cm, clear_height_km.
        construction
            When it was built: sets the U-values. One of until_1978, until_1994, until_2001, enev_2007,
            enev_2016. Default: enev_2007.
        layout
            Shape of the footprint. One of compact, elongated. Default: compact.
        attached_buildings
            Buildings attached to its short sides: 0, 1 or 2. Default: 0.
        window_share
            Windows per heated area. Default: 0.15.
        window_g
            Share of the sun on the windows that comes in: glass. Default: 0.6.
        window_shading
            Share of it that frames and shades leave. Default: 0.7.
        dormers
            Whether the roof has dormers. Default: False.
        azimuth_rad
            Where the main front looks, from south, west positive, rad. Default: 0.0. Also azimuth_deg.
        wall_insulation_m
            Insulation added to the walls (0.035 W/(m K)), m. Default: 0.0. Also wall_insulation_mm,
            wall_insulation_cm, wall_insulation_km.
        wall_insulated_share
            Share of the walls that has it. Default: 1.0.
        ceiling_insulation_m
            Insulation added to the top ceiling, m. Default: 0.0. Also ceiling_insulation_mm,
            ceiling_insulation_cm, ceiling_insulation_km.
        ceiling_insulated_share
            Share of the top ceiling that has it. Default: 1.0.
        floor_insulation_m
            Insulation added to the floor above the cellar, m. Default: 0.0. Also floor_insulation_mm,
            floor_insulation_cm, floor_insulation_km.
        wall_w_m2_k
            U-value of the walls instead of that of the construction, W/(m2 K).
        ceiling_w_m2_k
            U-value of the top ceiling instead of that of the construction, W/(m2 K).
        floor_w_m2_k
            U-value of the floor above the cellar instead of that of the construction, W/(m2 K).
        window_w_m2_k
            U-value of the windows instead of that of the construction, W/(m2 K).
        air_j_m2_k
            Heat capacity of air and furniture per heated area, J/(m2 K). Default: 216000.0. Also
            air_j_m2_degc.
        inner_j_m2_k
            Heat capacity of inner walls per heated area, J/(m2 K). Default: 324000.0. Also inner_j_m2_degc.
        air_change_absent_1_s
            Air changes while nobody is there, 1/s. Default: 8.333333333333333e-05. Also air_change_absent_1_h.
        air_change_present_1_s
            Air changes while everybody is there, 1/s. Default: 0.00016666666666666666. Also
            air_change_present_1_h.
        inhabitants
            People who live there. Default: 6.0.
        person_w
            Heat of a person who is there with what it uses, W. Default: 110.0. Also person_kw, person_mw.
        emitter
            What gives heat to the rooms. One of radiator, floor. Default: floor.
        heating_w_m2
            Nominal heat of the emitter per heated area, W/m2. Default: 15.0.
        nominal_supply_k
            Nominal supply temperature, K; default by the emitter. Also nominal_supply_degc.
        nominal_return_k
            Nominal return temperature, K; default by the emitter. Also nominal_return_degc.
        nominal_room_k
            Room temperature of the nominal point, K. Default: 294.15. Also nominal_room_degc.
        emitter_exponent
            Exponent of the emitter; default by the emitter.
        emitter_capacity_j_k
            Heat capacity of the emitter, J/K; default by the emitter. Also emitter_capacity_kj_k.
        heating
            Whether it has the port `heating`. Default: True.
        cooling
            Whether it has the port `cooling`: cold water through the same emitter. Default: False.
        cooling_w_m2_k
            Emission of a floor that is colder than the room, per heated area, W/(m2 K). Default: 5.5.
        v_flow_max_m3_s
            Largest flow through the emitter, m3/s. Default: 0.00025. Also v_flow_max_l_s, v_flow_max_l_min,
            v_flow_max_l_h, v_flow_max_m3_h.
        room_set_k
            Set point of heating while nothing drives it, K. Default: 294.15. Also room_set_degc.
        cooling_set_k
            Set point of cooling while nothing drives it, K. Default: 296.15. Also cooling_set_degc.
        thermostat_difference_k
            Difference of room temperatures between thermostat shut and open, K. Default: 1.0.
        thermostat_reset_s
            Reset time of the thermostats, s; 0: proportional only. Default: 0.0. Also thermostat_reset_min,
            thermostat_reset_h, thermostat_reset_d.
        night_set_k
            Set point that is not exceeded at night, K; without it there is no night reduction. Also
            night_set_degc.
        night_from_s
            When the night begins, s after midnight. Default: 82800.0. Also night_from_min, night_from_h,
            night_from_d.
        night_until_s
            When the night ends, s after midnight. Default: 21600.0. Also night_until_min, night_until_h,
            night_until_d.
        night_off_from_s
            When the night of Saturdays, Sundays and holidays begins, s after midnight. With it or
            `night_off_until_s` the days and the time of day are those of the calendar: `start` of the run and
            `utc_offset_s`; a night is that of the day it is in. Also night_off_from_min, night_off_from_h,
            night_off_from_d.
        night_off_until_s
            When the night of these days ends, s after midnight. Also night_off_until_min, night_off_until_h,
            night_off_until_d.
        holidays
            Holidays of that calendar, `"2024-12-25"`.
        utc_offset_s
            Local clock of that calendar ahead of the `start` of the run (UTC), s; no daylight saving time.
            Default: 3600.0. Also utc_offset_min, utc_offset_h, utc_offset_d.
        start_time_s
            Time of day at which the run starts, s after midnight. Default: 0.0. Also start_time_min,
            start_time_h, start_time_d.
        absent_set_k
            Set point while nobody is there, K; without it the set point does not follow the presence. Also
            absent_set_degc.
        heating_limit_k
            Heating season below this running mean of the outdoor temperature, K. Default: 287.15. Also
            heating_limit_degc.
        initial_living_k
            Temperature of the living area at the start, K. Default: 294.15. Also initial_living_degc.
        initial_roof_k
            Temperature of the roof space at the start, K. Default: 274.65. Also initial_roof_degc.
        initial_cellar_k
            Temperature of the cellar at the start, K. Default: 280.15. Also initial_cellar_degc.
        outdoor_k
            Outdoor temperature while nothing drives it, K. Default: 278.15. Also outdoor_degc.
        ground_k
            Temperature of the ground while nothing drives it, K. Default: 283.15. Also ground_degc.
        """
    def storage(
        self,
        site: str | None = None,
        *,
        name: str | None = None,
        station: str | None = None,
        id: str | None = None,
        port: str | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        height_m: float | None = None,
        height_mm: float | None = None,
        height_cm: float | None = None,
        height_km: float | None = None,
        layers: int | None = None,
        scheme: Literal["mixed_layers", "plug_flow"] | None = None,
        ports: Mapping[str, _Ports] | None = None,
        coils: Mapping[str, _Coils] | None = None,
        rod: _Rod | None = None,
        u_w_m2_k: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        bridges_w_k: Sequence[float] | None = None,
        bridges_kw_k: Sequence[float] | None = None,
        ambient_k: float | None = None,
        ambient_degc: float | None = None,
        conductivity_w_m_k: float | None = None,
        buoyancy: Literal["gradual", "at_once"] | None = None,
        buoyancy_w_k: float | None = None,
        buoyancy_kw_k: float | None = None,
        entrainment_m: float | None = None,
        entrainment_mm: float | None = None,
        entrainment_cm: float | None = None,
        entrainment_km: float | None = None,
        jet_share: float | None = None,
        jet_richardson: float | None = None,
        port_diameter_m: float | None = None,
        port_diameter_mm: float | None = None,
        port_diameter_cm: float | None = None,
        port_diameter_km: float | None = None,
        soc_empty_k: float | None = None,
        soc_empty_degc: float | None = None,
        soc_full_k: float | None = None,
        soc_full_degc: float | None = None,
        initial_k: float | None = None,
        initial_degc: float | None = None,
        initial_bottom_k: float | None = None,
        initial_bottom_degc: float | None = None,
        initial_top_k: float | None = None,
        initial_top_degc: float | None = None,
        initial_layers_k: Sequence[float] | None = None,
        initial_layers_degc: Sequence[float] | None = None,
        initial_sensors_k: Sequence[float] | None = None,
        initial_sensors_degc: Sequence[float] | None = None,
    ) -> str | None:
        """Adds `[[unit]]` with kind = "storage".

        A storage as written in a model file.

        Parameters
        ----------
        site
            Site whose station it stands behind, or whose circuits it is part of
        name
            Name within its site; default unit
        station
            Name of the station; default station
        id
            Name, where no site is given
        port
            Edge it stands on, where no site is given and not all its ports are in circuits
        volume_m3
            Volume of its water, m3. Also volume_l.
        height_m
            Height of its water, m. Also height_mm, height_cm, height_km.
        layers
            Number of layers of equal height, 1 to 200; layer 1 is at the bottom. Default: 10.
        scheme
            How water moves between the layers: `mixed_layers` or `plug_flow`. One of mixed_layers, plug_flow.
            Default: mixed_layers.
        ports
            Where water passes through the tank, by name.
        coils
            Coils in the tank, by name.
        rod
            Electric rod in the tank.
        u_w_m2_k
            Loss per area of the envelope, W/(m2 K); 0.35 without this and `ua_w_k`.
        ua_w_k
            Loss of the whole envelope, W/K. Also ua_kw_k.
        bridges_w_k
            Loss of pipes, feet and other bridges at each layer, W/K, from the bottom. Also bridges_kw_k.
        ambient_k
            Temperature around the storage while nothing drives it, K. Default: 291.15. Also ambient_degc.
        conductivity_w_m_k
            Conductivity of water, wall and built-in parts over the cross-section of the water, W/(m K).
            Default: 0.644.
        buoyancy
            What becomes of warm water below cold water: `gradual` or `at_once`. One of gradual, at_once.
            Default: gradual.
        buoyancy_w_k
            Conductance with which heat rises from a layer to a colder one above it, W/K. Default: 900.0. Also
            buoyancy_kw_k.
        entrainment_m
            How far below and above a port water is drawn along with what leaves, m. Default: 0.0. Also
            entrainment_mm, entrainment_cm, entrainment_km.
        jet_share
            Share of the water that enters which mixes with the neighbouring layers where it has no buoyancy; 0
            for none. Default: 0.0.
        jet_richardson
            Richardson number of the jet at which half of that is left. Default: 1.0.
        port_diameter_m
            Inner diameter of the ports, m: it gives the velocity of the jet. Default: 0.025. Also
            port_diameter_mm, port_diameter_cm, port_diameter_km.
        soc_empty_k
            Temperature at which the state of charge is 0, K. Default: 303.15. Also soc_empty_degc.
        soc_full_k
            Temperature at which the state of charge is 1, K. Default: 363.15. Also soc_full_degc.
        initial_k
            Temperature at the start, K; without one of these fields that of the run. Also initial_degc.
        initial_bottom_k
            Temperature of the lowest layer at the start, K; linear up to `initial_top_k`. Also
            initial_bottom_degc.
        initial_top_k
            Temperature of the highest layer at the start, K. Also initial_top_degc.
        initial_layers_k
            Temperatures of the layers at the start, K, from the bottom. Also initial_layers_degc.
        initial_sensors_k
            Temperatures at the start of any number of sensors evenly along the height, K, from the bottom.
            Also initial_sensors_degc.
        """

class _Controller:
    def pi(
        self,
        *,
        id: str | None = None,
        measures: str | None = None,
        acts_on: str | None = None,
        set_point: float | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
        dead_band: float | None = None,
        schedule_output: Sequence[float] | None = None,
        schedule_factor: Sequence[float] | None = None,
        off_at_zero: bool | None = None,
        initial_output: float | None = None,
        output_min: float | None = None,
        output_max: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "pi".

        A PI controller as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures
            Channel it measures
        acts_on
            Signal it drives
        set_point
            Wanted value of the measured signal, in its SI unit.
        gain
            Proportional gain: actuator unit per SI unit of the measured signal. Negative when a larger
            actuator value lowers the measured one.
        integral_time_s
            Integral time, s. Also integral_time_min, integral_time_h, integral_time_d.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s: controllers of one interval and different offsets take turns. Also
            offset_min, offset_h, offset_d.
        dead_band
            Errors up to this size, in the unit of the measured signal, are left alone.
        schedule_output
            Outputs at which the gain is scheduled, rising.
        schedule_factor
            Factors of the gain at those outputs; straight in between.
        off_at_zero
            Whether a set point of zero switches off: the smallest output, from which it begins anew.
        initial_output
            Output at the start of a run. Default: 0.0.
        output_min
            Smallest output. Absent: the actuator's limit.
        output_max
            Largest output. Absent: the actuator's limit.
        """
    def cascade(
        self,
        *,
        id: str | None = None,
        measures: str | None = None,
        inner_measures: str | None = None,
        acts_on: str | None = None,
        set_point: float | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        inner_set_min: float | None = None,
        inner_set_max: float | None = None,
        inner_set_initial: float | None = None,
        inner_gain: float | None = None,
        inner_integral_time_s: float | None = None,
        inner_integral_time_min: float | None = None,
        inner_integral_time_h: float | None = None,
        inner_integral_time_d: float | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
        initial_output: float | None = None,
        output_min: float | None = None,
        output_max: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "cascade".

        A cascade as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures
            Channel it measures
        inner_measures
            Channel it measures
        acts_on
            Signal it drives
        set_point
            Wanted value of the signal that the outer controller measures, in its SI unit.
        gain
            Gain of the outer controller: inner unit per outer unit (Pa/K for a pressure difference that holds
            a temperature).
        integral_time_s
            Integral time of the outer controller, s. Also integral_time_min, integral_time_h, integral_time_d.
        inner_set_min
            Smallest set point of the inner controller, in its SI unit.
        inner_set_max
            Largest set point of the inner controller.
        inner_set_initial
            Set point of the inner controller at the start. Absent: the smallest.
        inner_gain
            Gain of the inner controller: actuator unit per inner unit.
        inner_integral_time_s
            Integral time of the inner controller, s. Also inner_integral_time_min, inner_integral_time_h,
            inner_integral_time_d.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        initial_output
            Output at the start of a run. Default: 0.0.
        output_min
            Smallest output. Absent: the actuator's limit.
        output_max
            Largest output. Absent: the actuator's limit.
        """
    def thermostatic_valve(
        self,
        *,
        id: str | None = None,
        measures: str | None = None,
        acts_on: str | None = None,
        set_point_k: float | None = None,
        set_point_degc: float | None = None,
        proportional_band_difference_k: float | None = None,
        time_constant_s: float | None = None,
        time_constant_min: float | None = None,
        time_constant_h: float | None = None,
        time_constant_d: float | None = None,
        opens_with_heat: bool | None = None,
        initial_output: float | None = None,
        output_min: float | None = None,
        output_max: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "thermostatic_valve".

        A thermostatic valve as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures
            Channel it measures
        acts_on
            Signal it drives
        set_point_k
            Temperature at which it is half open, K. Also set_point_degc.
        proportional_band_difference_k
            Change of temperature from closed to open, K. Default: 10.0.
        time_constant_s
            Time constant of sensor and stem, s. Default: 60.0. Also time_constant_min, time_constant_h,
            time_constant_d.
        opens_with_heat
            Whether it opens with rising temperature, as for cooling; otherwise it closes. Default: False.
        initial_output
            Opening at the start of a run. Default: 0.5.
        output_min
            Smallest opening, for example a by-pass. Absent: the valve's limit.
        output_max
            Largest opening. Absent: the valve's limit.
        """
    def hysteresis(
        self,
        *,
        id: str | None = None,
        measures: str | None = None,
        acts_on: str | None = None,
        set_point: float | None = None,
        band: float | None = None,
        on_output: float | None = None,
        off_output: float | None = None,
        on_above: bool | None = None,
        initially_on: bool | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "hysteresis".

        An on-off controller as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures
            Channel it measures
        acts_on
            Signal it drives
        set_point
            Middle of the band, in the SI unit of the measured signal.
        band
            Width of the band, in the same unit.
        on_output
            Output while on. Default: 1.0.
        off_output
            Output while off. Default: 0.0.
        on_above
            On above the band instead of below it. Default: False.
        initially_on
            On at the start of a run. Default: False.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        """
    def weighted_pi(
        self,
        *,
        id: str | None = None,
        measures_heat: str | None = None,
        measures_primary_hot: str | None = None,
        measures_primary_cold: str | None = None,
        measures_secondary_hot: str | None = None,
        measures_secondary_cold: str | None = None,
        acts_on_pump: str | None = None,
        acts_on_valve: str | None = None,
        acts_on_secondary: str | None = None,
        station: str | None = None,
        q_flow_w: float | None = None,
        q_flow_kw: float | None = None,
        q_flow_mw: float | None = None,
        variant: Literal["crossover", "same_side", "mixed_1", "mixed_2"] | None = None,
        primary_hot_k: float | None = None,
        primary_hot_degc: float | None = None,
        secondary_hot_k: float | None = None,
        secondary_hot_degc: float | None = None,
        primary_difference_k: float | None = None,
        secondary_difference_k: float | None = None,
        feed_in_primary_gain: float | None = None,
        feed_in_primary_integral_time_s: float | None = None,
        feed_in_primary_integral_time_min: float | None = None,
        feed_in_primary_integral_time_h: float | None = None,
        feed_in_primary_integral_time_d: float | None = None,
        feed_in_primary_alpha: float | None = None,
        feed_in_secondary_gain_m3_s: float | None = None,
        feed_in_secondary_gain_l_s: float | None = None,
        feed_in_secondary_gain_l_min: float | None = None,
        feed_in_secondary_gain_l_h: float | None = None,
        feed_in_secondary_gain_m3_h: float | None = None,
        feed_in_secondary_integral_time_s: float | None = None,
        feed_in_secondary_integral_time_min: float | None = None,
        feed_in_secondary_integral_time_h: float | None = None,
        feed_in_secondary_integral_time_d: float | None = None,
        feed_in_secondary_alpha: float | None = None,
        extraction_primary_gain: float | None = None,
        extraction_primary_integral_time_s: float | None = None,
        extraction_primary_integral_time_min: float | None = None,
        extraction_primary_integral_time_h: float | None = None,
        extraction_primary_integral_time_d: float | None = None,
        extraction_primary_alpha: float | None = None,
        extraction_secondary_gain_m3_s: float | None = None,
        extraction_secondary_gain_l_s: float | None = None,
        extraction_secondary_gain_l_min: float | None = None,
        extraction_secondary_gain_l_h: float | None = None,
        extraction_secondary_gain_m3_h: float | None = None,
        extraction_secondary_integral_time_s: float | None = None,
        extraction_secondary_integral_time_min: float | None = None,
        extraction_secondary_integral_time_h: float | None = None,
        extraction_secondary_integral_time_d: float | None = None,
        extraction_secondary_alpha: float | None = None,
        q_flow_norm_w: float | None = None,
        q_flow_norm_kw: float | None = None,
        q_flow_norm_mw: float | None = None,
        norm_difference_k: float | None = None,
        idle_band_w: float | None = None,
        idle_band_kw: float | None = None,
        idle_band_mw: float | None = None,
        speed_min: float | None = None,
        speed_max: float | None = None,
        kappa_min: float | None = None,
        kappa_max: float | None = None,
        v_flow_min_m3_s: float | None = None,
        v_flow_min_l_s: float | None = None,
        v_flow_min_l_min: float | None = None,
        v_flow_min_l_h: float | None = None,
        v_flow_min_m3_h: float | None = None,
        v_flow_max_m3_s: float | None = None,
        v_flow_max_l_s: float | None = None,
        v_flow_max_l_min: float | None = None,
        v_flow_max_l_h: float | None = None,
        v_flow_max_m3_h: float | None = None,
        start_share: float | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "weighted_pi".

        A weighted PI controller as written in a model file; with `station` it finds its channels and signals.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures_heat
            Channel it measures
        measures_primary_hot
            Channel it measures
        measures_primary_cold
            Channel it measures
        measures_secondary_hot
            Channel it measures
        measures_secondary_cold
            Channel it measures
        acts_on_pump
            Signal it drives
        acts_on_valve
            Signal it drives
        acts_on_secondary
            Signal it drives
        station
            Station whose channels and signals it takes where they are not named one by one
        q_flow_w
            Wanted heat, W: positive feeds in, negative extracts; the signal `ID.q_flow_w`. Default: 0.0. Also
            q_flow_kw, q_flow_mw.
        variant
            Which temperature each side looks after. One of crossover, same_side, mixed_1, mixed_2. Default:
            crossover.
        primary_hot_k
            Wanted temperature of the hot primary side, K (feed-in). Default: 326.65. Also primary_hot_degc.
        secondary_hot_k
            Wanted temperature of the hot secondary side, K (extraction). Default: 323.15. Also
            secondary_hot_degc.
        primary_difference_k
            Wanted difference of the primary temperatures, K (extraction). Default: 20.0.
        secondary_difference_k
            Wanted difference of the secondary temperatures, K (feed-in). Default: 20.0.
        feed_in_primary_gain
            Gain of the pump: speed per weighted error. Default: 1.5.
        feed_in_primary_integral_time_s
            Integral time of the pump, s. Default: 8.0. Also feed_in_primary_integral_time_min,
            feed_in_primary_integral_time_h, feed_in_primary_integral_time_d.
        feed_in_primary_alpha
            Weight of the heat for the pump. Absent: 2/3 in crossover, 1/3 on the same side.
        feed_in_secondary_gain_m3_s
            Gain of the secondary flow in feed-in, m3/s per weighted error. Default: 2.5e-05. Also
            feed_in_secondary_gain_l_s, feed_in_secondary_gain_l_min, feed_in_secondary_gain_l_h,
            feed_in_secondary_gain_m3_h.
        feed_in_secondary_integral_time_s
            Integral time of the secondary flow in feed-in, s. Default: 8.0. Also
            feed_in_secondary_integral_time_min, feed_in_secondary_integral_time_h,
            feed_in_secondary_integral_time_d.
        feed_in_secondary_alpha
            Weight of the heat for the secondary flow in feed-in. Absent: what the pump's lacks to 1.
        extraction_primary_gain
            Gain of the valve: flow coefficient per weighted error. Default: 1.0.
        extraction_primary_integral_time_s
            Integral time of the valve, s. Default: 35.0. Also extraction_primary_integral_time_min,
            extraction_primary_integral_time_h, extraction_primary_integral_time_d.
        extraction_primary_alpha
            Weight of the heat for the valve. Absent: 1/3 in crossover, 2/3 on the same side.
        extraction_secondary_gain_m3_s
            Gain of the secondary flow in extraction, m3/s per weighted error. Default: 2.5e-05. Also
            extraction_secondary_gain_l_s, extraction_secondary_gain_l_min, extraction_secondary_gain_l_h,
            extraction_secondary_gain_m3_h.
        extraction_secondary_integral_time_s
            Integral time of the secondary flow in extraction, s. Default: 8.0. Also
            extraction_secondary_integral_time_min, extraction_secondary_integral_time_h,
            extraction_secondary_integral_time_d.
        extraction_secondary_alpha
            Weight of the heat for the secondary flow in extraction. Absent: what the valve's lacks to 1.
        q_flow_norm_w
            Error of the heat that counts as one, W. Default: 1000.0. Also q_flow_norm_kw, q_flow_norm_mw.
        norm_difference_k
            Error of a temperature that counts as one, K. Default: 3.0.
        idle_band_w
            Set heats smaller than this are idleness, W. Default: 100.0. Also idle_band_kw, idle_band_mw.
        speed_min
            Smallest speed of the pump while it feeds in. Default: 0.25.
        speed_max
            Largest speed of the pump. Default: 1.0.
        kappa_min
            Smallest flow coefficient of the valve while it extracts. Default: 0.25.
        kappa_max
            Largest flow coefficient of the valve. Default: 1.0.
        v_flow_min_m3_s
            Smallest secondary flow while not idle, m3/s. Default: 3.3333333333333335e-05. Also v_flow_min_l_s,
            v_flow_min_l_min, v_flow_min_l_h, v_flow_min_m3_h.
        v_flow_max_m3_s
            Largest secondary flow, m3/s. Default: 0.00014166666666666668. Also v_flow_max_l_s,
            v_flow_max_l_min, v_flow_max_l_h, v_flow_max_m3_h.
        start_share
            Where both outputs of a mode start between their limits: 0 at the smallest, 1 at the largest.
            Default: 0.0.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        """
    def two_step(
        self,
        *,
        id: str | None = None,
        measures_primary_hot: str | None = None,
        measures_secondary_hot: str | None = None,
        measures_hot_pressure: str | None = None,
        measures_cold_pressure: str | None = None,
        acts_on_pump: str | None = None,
        supply_k: float | None = None,
        supply_degc: float | None = None,
        margin_difference_k: float | None = None,
        band_difference_k: float | None = None,
        head_max_pa: float | None = None,
        head_max_hpa: float | None = None,
        head_max_mbar: float | None = None,
        head_max_kpa: float | None = None,
        head_max_bar: float | None = None,
        head_max_mpa: float | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
        speed_min: float | None = None,
        speed_max: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "two_step".

        A two-step controller as written in a model file; with `station` it finds its channels and signal.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures_primary_hot
            Channel it measures
        measures_secondary_hot
            Channel it measures
        measures_hot_pressure
            Channel it measures
        measures_cold_pressure
            Channel it measures
        acts_on_pump
            Signal it drives
        supply_k
            Wanted temperature of the water fed in, K; the signal `ID.supply_k`. Also supply_degc.
        margin_difference_k
            The house must be warmer than that by this much, K. Default: 5.0.
        band_difference_k
            By how much its temperature may fall again before the pump stops, K. Default: 2.0.
        head_max_pa
            Head of the pump at zero flow and full speed, Pa. Also head_max_hpa, head_max_mbar, head_max_kpa,
            head_max_bar, head_max_mpa.
        gain
            Gain: speed per K. Default: 0.01.
        integral_time_s
            Integral time, s. Default: 30.0. Also integral_time_min, integral_time_h, integral_time_d.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        speed_min
            Smallest speed while released, with which hot water reaches the sensor. Default: 0.1.
        speed_max
            Largest speed. Default: 1.0.
        """
    def storage_charging(
        self,
        *,
        id: str | None = None,
        measures_top: str | None = None,
        measures_middle: str | None = None,
        measures_valve: str | None = None,
        acts_on_modulation: str | None = None,
        acts_on_valve: str | None = None,
        top_start_k: float | None = None,
        top_start_degc: float | None = None,
        top_stop_k: float | None = None,
        top_stop_degc: float | None = None,
        middle_start_k: float | None = None,
        middle_start_degc: float | None = None,
        middle_stop_k: float | None = None,
        middle_stop_degc: float | None = None,
        valve_on_k: float | None = None,
        valve_on_degc: float | None = None,
        valve_off_k: float | None = None,
        valve_off_degc: float | None = None,
        valve_top: float | None = None,
        valve_middle: float | None = None,
        modulating: bool | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "storage_charging".

        Charging as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures_top
            Channel it measures
        measures_middle
            Channel it measures
        measures_valve
            Channel it measures
        acts_on_modulation
            Signal it drives
        acts_on_valve
            Signal it drives
        top_start_k
            Full power for the top at this temperature of its reference layer, K. Default: 325.15. Also
            top_start_degc.
        top_stop_k
            No power for the top from this temperature on, K. Default: 331.15. Also top_stop_degc.
        middle_start_k
            Full power for the middle at this temperature of its reference layer, K. Default: 307.15. Also
            middle_start_degc.
        middle_stop_k
            No power for the middle from this temperature on, K. Default: 313.15. Also middle_stop_degc.
        valve_on_k
            The valve turns to the top below this temperature, K. Default: 328.15. Also valve_on_degc.
        valve_off_k
            The valve turns to the middle above this temperature, K. Default: 331.15. Also valve_off_degc.
        valve_top
            Position of the valve for the top. Default: 0.0.
        valve_middle
            Position of the valve for the middle. Default: 1.0.
        modulating
            Whether the power follows the factor, or is on or off. Default: True.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        """
    def balancing(
        self,
        *,
        id: str | None = None,
        measures_flow: str | None = None,
        measures_heating: str | None = None,
        measures_cooling: str | None = None,
        acts_on_modulation: str | None = None,
        acts_on_mode: str | None = None,
        acts_on_valve: str | None = None,
        heating_start_k: float | None = None,
        heating_start_degc: float | None = None,
        heating_stop_k: float | None = None,
        heating_stop_degc: float | None = None,
        cooling_start_k: float | None = None,
        cooling_start_degc: float | None = None,
        cooling_stop_k: float | None = None,
        cooling_stop_degc: float | None = None,
        dead_band_kg_s: float | None = None,
        dead_band_kg_min: float | None = None,
        dead_band_kg_h: float | None = None,
        mode_time_s: float | None = None,
        mode_time_min: float | None = None,
        mode_time_h: float | None = None,
        mode_time_d: float | None = None,
        valve_heating: float | None = None,
        valve_cooling: float | None = None,
        modulating: bool | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "balancing".

        Balancing as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures_flow
            Channel it measures
        measures_heating
            Channel it measures
        measures_cooling
            Channel it measures
        acts_on_modulation
            Signal it drives
        acts_on_mode
            Signal it drives
        acts_on_valve
            Signal it drives
        heating_start_k
            Full heating at this temperature of its reference layer, K. Default: 289.65. Also
            heating_start_degc.
        heating_stop_k
            No heating from this temperature on, K. Default: 292.65. Also heating_stop_degc.
        cooling_start_k
            Full cooling at this temperature of its reference layer, K. Default: 291.15. Also
            cooling_start_degc.
        cooling_stop_k
            No cooling from this temperature down, K. Default: 288.15. Also cooling_stop_degc.
        dead_band_kg_s
            Flows up to this one, either way, are no demand, kg/s. Default: 0.008333333333333333. Also
            dead_band_kg_min, dead_band_kg_h.
        mode_time_s
            Time for which a mode lasts at least, s. Default: 300.0. Also mode_time_min, mode_time_h,
            mode_time_d.
        valve_heating
            Position of the valve for heating. Default: 0.0.
        valve_cooling
            Position of the valve for cooling. Default: 1.0.
        modulating
            Whether the power follows the factor, or is on or off. Default: True.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        """
    def two_sensors(
        self,
        *,
        id: str | None = None,
        measures_on: str | None = None,
        measures_off: str | None = None,
        acts_on: str | None = None,
        on_below_k: float | None = None,
        on_below_degc: float | None = None,
        off_above_k: float | None = None,
        off_above_degc: float | None = None,
        on_output: float | None = None,
        off_output: float | None = None,
        initially_on: bool | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "two_sensors".

        On by one sensor, off by another, as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures_on
            Channel it measures
        measures_off
            Channel it measures
        acts_on
            Signal it drives
        on_below_k
            On where `measures_on` is below this, K. Also on_below_degc.
        off_above_k
            Off where `measures_off` is above this, K. Also off_above_degc.
        on_output
            Output while on. Default: 1.0.
        off_output
            Output while off. Default: 0.0.
        initially_on
            On at the start of a run. Default: False.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        """
    def tank_charging(
        self,
        *,
        id: str | None = None,
        measures_tank: str | None = None,
        measures_source: str | None = None,
        acts_on: str | None = None,
        on_below_k: float | None = None,
        on_below_degc: float | None = None,
        off_above_k: float | None = None,
        off_above_degc: float | None = None,
        warmer_by_difference_k: float | None = None,
        on_output: float | None = None,
        off_output: float | None = None,
        initially_on: bool | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "tank_charging".

        The charging of a tank of hot water as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures_tank
            Channel it measures
        measures_source
            Channel it measures
        acts_on
            Signal it drives
        on_below_k
            On where the top of the tank is below this, K. Default: 323.15. Also on_below_degc.
        off_above_k
            Off where the top of the tank is above this, K. Default: 338.15. Also off_above_degc.
        warmer_by_difference_k
            The storage must be warmer than the tank by more than this, K. Default: 0.0.
        on_output
            Output while on: of the flow of a circuit, m3/s. Default: 1.0.
        off_output
            Output while off. Default: 0.0.
        initially_on
            On at the start of a run. Default: False.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        """
    def rule(
        self,
        *,
        id: str | None = None,
        acts_on: str | None = None,
        on: str | None = None,
        off: str | None = None,
        lock: str | None = None,
        unlock: str | None = None,
        on_output: float | None = None,
        off_output: float | None = None,
        safe_output: float | None = None,
        initially_on: bool | None = None,
        role: Literal["rule", "backup"] | None = None,
        wanted: float | None = None,
        wanted_min: float | None = None,
        wanted_max: float | None = None,
        timeout_s: float | None = None,
        timeout_min: float | None = None,
        timeout_h: float | None = None,
        timeout_d: float | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "rule".

        A rule as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        acts_on
            Signal it drives
        on
            When it goes on, for example "storage.soc < 0.6 and storage.t_8_k < 65 degC".
        off
            When it goes off, for example "storage.t_3_k > 70 degC". Absent: where `on` does not hold.
        lock
            When it is locked for safety.
        unlock
            When the lock is released. Absent: where `lock` does not hold.
        on_output
            Output while on. Default: 1.0.
        off_output
            Output while off. Default: 0.0.
        safe_output
            Output while locked, and instead of what must not be wanted. Absent: that of off.
        initially_on
            On at the start of a run. Default: False.
        role
            Whether it decides, or only helps out behind what an energy management wants. One of rule, backup.
            Default: rule.
        wanted
            Output that is wanted while nothing drives the signal; for a backup. Absent: that of off.
        wanted_min
            The smallest value that may be wanted; for a backup. Absent: the smaller of both outputs.
        wanted_max
            The largest value that may be wanted; for a backup. Absent: the larger of both outputs.
        timeout_s
            What is wanted counts no more where the signal `heartbeat` has not changed for so long, s; for a
            backup. Also timeout_min, timeout_h, timeout_d.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        """
    def feed_forward(
        self,
        *,
        id: str | None = None,
        measures: str | None = None,
        acts_on: str | None = None,
        q_flow_w: float | None = None,
        q_flow_kw: float | None = None,
        q_flow_mw: float | None = None,
        temperature_difference_k: float | None = None,
        heat_capacity_j_kg_k: float | None = None,
        heat_capacity_kj_kg_k: float | None = None,
        gain: float | None = None,
        integral_time_s: float | None = None,
        integral_time_min: float | None = None,
        integral_time_h: float | None = None,
        integral_time_d: float | None = None,
        interval_s: float | None = None,
        interval_min: float | None = None,
        interval_h: float | None = None,
        interval_d: float | None = None,
        offset_s: float | None = None,
        offset_min: float | None = None,
        offset_h: float | None = None,
        offset_d: float | None = None,
        output_min: float | None = None,
        output_max: float | None = None,
    ) -> str | None:
        """Adds `[[controller]]` with kind = "feed_forward".

        A feed-forward controller as written in a model file.

        Parameters
        ----------
        id
            Name; default that of the first signal, with .controller
        measures
            Channel it measures
        acts_on
            Signal it drives
        q_flow_w
            Wanted heat, W, of either sign; the signal `ID.q_flow_w`. Also q_flow_kw, q_flow_mw.
        temperature_difference_k
            Temperature difference that is expected of the water, K.
        heat_capacity_j_kg_k
            Heat capacity of the water, J/(kg K). Default: 4180.0. Also heat_capacity_kj_kg_k.
        gain
            Gain of the trim, kg/s per W. Default: 2e-06.
        integral_time_s
            Integral time of the trim, s. Default: 60.0. Also integral_time_min, integral_time_h,
            integral_time_d.
        interval_s
            Time between two updates, s; 0 updates at every step. Default: 0.0. Also interval_min, interval_h,
            interval_d.
        offset_s
            Time of the first update, s. Default: 0.0. Also offset_min, offset_h, offset_d.
        output_min
            Smallest flow, kg/s. Absent: the actuator's limit.
        output_max
            Largest flow, kg/s. Absent: the actuator's limit.
        """

class _Effect:
    def p1(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        wall_capacity_j_m_k: float | None = None,
        film_factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P1".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        wall_capacity_j_m_k
            Heat capacity of the wall per length, J/(m K); 0 leaves the wall that the pipe has. Default: 0.0.
        film_factor
            Heat transfer between water and wall over what its law says; without a wall it changes nothing.
            Default: 1.0.
        """
    def p2(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P2".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Heat loss over what the data of the pipe say; 1 changes nothing.
        """
    def p3(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        difference_k: float | None = None,
        lag_s: float | None = None,
        lag_min: float | None = None,
        lag_h: float | None = None,
        lag_d: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P3".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        difference_k
            Added to the temperature around the pipe, K; 0 changes nothing. Default: 0.0.
        lag_s
            How much later than assumed the temperature arrives, s; 0 changes nothing. Default: 0.0. Also
            lag_min, lag_h, lag_d.
        """
    def p4(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        capacity_j_m_k: float | None = None,
        share: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P4".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        capacity_j_m_k
            Heat capacity per length, J/(m K); 0 changes nothing.
        share
            Share of the thermal resistance of the pipe that lies beyond it. Default: 0.5.
        """
    def p5(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P5".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Heat loss at zero flow over that in flow; 1 changes nothing.
        """
    def p6(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P6".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        volume_m3
            Water of the missing piece, m3; 0 changes nothing. Also volume_l.
        """
    def p7(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        dispersion_m2_s: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P7".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        dispersion_m2_s
            Dispersion coefficient D added to that of the pipe, m2/s; 0 changes nothing.
        """
    def p8(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
        added_roughness_m: float | None = None,
        added_roughness_mm: float | None = None,
        added_roughness_cm: float | None = None,
        added_roughness_km: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P8".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Pressure loss over what the data of the pipe say; 1 changes nothing. Default: 1.0.
        added_roughness_m
            What deposits add to the roughness of the wall, m; 0 changes nothing. Default: 0.0. Also
            added_roughness_mm, added_roughness_cm, added_roughness_km.
        """
    def p10(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P10".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Length over the plan's; 1 changes nothing.
        """
    def h1(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        opening: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "H1".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        opening
            Conductance of the branch while its pump is off, as a share of that in operation; 0 changes
            nothing.
        """
    def h2(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        share: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "H2".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        share
            Share of what the strongest parallel pump delivers more that this one draws with it; 0 changes
            nothing.
        """
    def h3(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "H3".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Head over the curve of the pump; 1 changes nothing.
        """
    def h4(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        share: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "H4".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        share
            What the closed valve lets through more, as a share of the open one; 0 changes nothing.
        """
    def t1(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "T1".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Heat loss over what the data of the storage say; 1 changes nothing.
        """
    def t2(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "T2".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Vertical conductivity over what the data of the storage say; 1 changes nothing.
        """
    def t3(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        depth_m: float | None = None,
        depth_mm: float | None = None,
        depth_cm: float | None = None,
        depth_km: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "T3".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        depth_m
            How much further below and above a port water is drawn along, m; 0 changes nothing. Also depth_mm,
            depth_cm, depth_km.
        """
    def t4(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        share: float | None = None,
        richardson: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "T4".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        share
            Share of the water that enters which mixes with each neighbouring layer; 0 changes nothing.
        richardson
            Richardson number at which half of that is left. Default: 1.0.
        """
    def g1(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "G1".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Efficiency, or COP, over what the data of the generator say; 1 changes nothing.
        """
    def g2(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor_20: float | None = None,
        factor_40: float | None = None,
        factor_60: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "G2".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor_20
            Efficiency, or COP, over what the data say at 20 % of the load; 1 changes nothing. Default: 1.0.
        factor_40
            The same at 40 %. Default: 1.0.
        factor_60
            The same at 60 %. Default: 1.0.
        """
    def g3(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        time_factor: float | None = None,
        energy_j: float | None = None,
        energy_kwh: float | None = None,
        energy_mwh: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "G3".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        time_factor
            Length of a start over what the data say; 1 changes nothing. Default: 1.0.
        energy_j
            Heat that a cold engine takes for itself besides, J; 0 changes nothing. Default: 0.0. Also
            energy_kwh, energy_mwh.
        """
    def g4(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        heat_w: float | None = None,
        heat_kw: float | None = None,
        heat_mw: float | None = None,
        after_s: float | None = None,
        after_min: float | None = None,
        after_h: float | None = None,
        after_d: float | None = None,
        duration_s: float | None = None,
        duration_min: float | None = None,
        duration_h: float | None = None,
        duration_d: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "G4".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        heat_w
            Heat taken from the water in a defrost at full speed, W; 0 changes nothing. Also heat_kw, heat_mw.
        after_s
            Operation in cold air until a defrost, s; that of the unit without it. Also after_min, after_h,
            after_d.
        duration_s
            Duration of a defrost, s; that of the unit without it. Also duration_min, duration_h, duration_d.
        """
    def g6(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "G6".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Power over its rating; 1 changes nothing.
        """
    def g7(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        capacity_j_k: float | None = None,
        capacity_kj_k: float | None = None,
        conductance_w_k: float | None = None,
        conductance_kw_k: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "G7".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        capacity_j_k
            Heat capacity of metal beside what the model has, J/K; 0 changes nothing. Also capacity_kj_k.
        conductance_w_k
            Conductance between metal and water, W/K. Default: 100.0. Also conductance_kw_k.
        """
    def x1(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        factor: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "X1".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        factor
            Conductance over what the data of the exchanger say; 1 changes nothing.
        """
    def h8(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        share: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "H8".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        share
            Share of the water that comes through the closed way; 0 changes nothing.
        """
    def p11(
        self,
        component: str,
        *,
        because: str | None = None,
        ci95: Any = None,
        m_flow_kg_s: float | None = None,
        m_flow_kg_min: float | None = None,
        m_flow_kg_h: float | None = None,
    ) -> None:
        """Adds `[[effect]]` with id = "P11".

        The effect as written.

        Parameters
        ----------
        component
            Component it belongs to
        because
            Why it is here; changes nothing
        ci95
            Interval of the value; changes nothing
        m_flow_kg_s
            Water that leaves at 1 bar above the atmosphere, kg/s; 0 changes nothing. Also m_flow_kg_min,
            m_flow_kg_h.
        """

class Grid:
    def __init__(
        self,
        name: str = "untitled",
        directory: str | PathLike[str] = ".",
        *,
        description: str | None = None,
        gravity: float | None = None,
        thermosiphon: bool | None = None,
        dissipation: bool | None = None,
        fluid_inertia: bool | None = None,
        latitude_rad: float | None = None,
        latitude_deg: float | None = None,
        longitude_rad: float | None = None,
        longitude_deg: float | None = None,
    ) -> None: ...
    station_type: Final[_StationType]
    station: Final[_Station]
    edge: Final[_Edge]
    unit: Final[_Unit]
    controller: Final[_Controller]
    effect: Final[_Effect]
    def to_dict(self) -> dict[str, Any]: ...
    def model(self) -> Model: ...
    def _repr_html_(self) -> str: ...
    def run(
        self,
        *,
        until: str | float | None = None,
        step: str | float | None = None,
        step_min: str | float | None = None,
        step_max: str | float | None = None,
        step_tolerance_difference_k: float | None = None,
        step_tolerance_flow: float | None = None,
        record: str | float | None = None,
        start: str | None = None,
        initial_k: float | None = None,
        initial_degc: float | None = None,
        initial: Literal["given", "steady"] | None = None,
    ) -> None:
        """Adds `[run]`.

        `[run]`: how long, how fine, from when.

        Parameters
        ----------
        until
            End of the run, for example "1h". Default: 1h.
        step
            Largest time step, for example "1s", or "auto": as long as flows, temperatures and controllers
            allow. Default: 1s.
        step_min
            Shortest automatic step. Default: 0.1s.
        step_max
            Longest automatic step. Default: 15m.
        step_tolerance_difference_k
            Error of a temperature that an automatic step may make at the ports of units, K. Default: 0.5.
        step_tolerance_flow
            Error of a flow that an automatic step may make, relative to the flow and at least to a tenth of
            its nominal flow; of the output of a continuous controller, relative to its range. Default: 0.01.
        record
            Time between recorded rows, for example "10s". Default: 10s.
        start
            Calendar time of the start, RFC 3339; needed only with calendar data.
        initial_k
            Temperature of all water at the start, K. Default: 293.15. Also initial_degc.
        initial
            What the run starts from. One of given, steady.
        """
    def fluid(
        self,
        *,
        kind: Literal["constant_water", "water", "ethylene_glycol", "propylene_glycol", "brine"] | None = None,
        density_kg_m3: float | None = None,
        heat_capacity_j_kg_k: float | None = None,
        heat_capacity_kj_kg_k: float | None = None,
        viscosity_pa_s: float | None = None,
        conductivity_w_m_k: float | None = None,
        reference_temperature_k: float | None = None,
        reference_temperature_degc: float | None = None,
        follow_temperature: bool | None = None,
        share: float | None = None,
        min_temperature_k: float | None = None,
        min_temperature_degc: float | None = None,
        max_temperature_k: float | None = None,
        max_temperature_degc: float | None = None,
    ) -> None:
        """Adds `[fluid]`.

        `[fluid]`: the water.

        Parameters
        ----------
        kind
            Property set. One of constant_water, water, ethylene_glycol, propylene_glycol, brine. Default:
            constant_water.
        density_kg_m3
            Density, kg/m3 (constant_water, brine). Default: 1000.0.
        heat_capacity_j_kg_k
            Specific heat capacity, J/(kg K) (constant_water, brine). Default: 4180.0. Also
            heat_capacity_kj_kg_k.
        viscosity_pa_s
            Dynamic viscosity, Pa s (constant_water, brine). Default: 0.0010016.
        conductivity_w_m_k
            Thermal conductivity, W/(m K) (constant_water, brine). Default: 0.6.
        reference_temperature_k
            Temperature at which density, heat capacity, viscosity and conductivity are taken, K (water,
            glycols); 50 degC suits heating grids, 15 degC ambient ones. Default: 323.15. Also
            reference_temperature_degc.
        follow_temperature
            Whether viscosity and density in the pressure losses of pipes follow the temperature of each
            (water, glycols). Default: False.
        share
            Share of the antifreeze in the mass, up to 0.6 (glycols).
        min_temperature_k
            Lowest temperature at which it is liquid, K (brine). Also min_temperature_degc.
        max_temperature_k
            Highest temperature, K (brine). Also max_temperature_degc.
        """
    def ground(
        self,
        *,
        kind: Literal["constant", "kusuda"] | None = None,
        temperature_k: float | None = None,
        temperature_degc: float | None = None,
        mean_k: float | None = None,
        mean_degc: float | None = None,
        amplitude_k: float | None = None,
        coldest_day: float | None = None,
        diffusivity_m2_s: float | None = None,
        conductivity_w_m_k: float | None = None,
        surface_resistance_m2_k_w: float | None = None,
        depth_m: float | None = None,
        depth_mm: float | None = None,
        depth_cm: float | None = None,
        depth_km: float | None = None,
    ) -> None:
        """Adds `[ground]`.

        `[ground]`: what surrounds the pipes.

        Parameters
        ----------
        kind
            How its temperature runs. One of constant, kusuda. Default: constant.
        temperature_k
            Temperature, K, of constant ground; also the signal `ground.temperature_k`. Default: 285.15. Also
            temperature_degc.
        mean_k
            Mean temperature of the year, K; kusuda. Default: 282.65. Also mean_degc.
        amplitude_k
            Amplitude of the surface temperature over the year, K; kusuda. Default: 10.0.
        coldest_day
            Day of the year on which the surface is coldest, with decimals, 0 is New Year; kusuda. Default:
            35.0.
        diffusivity_m2_s
            Thermal diffusivity, m2/s. Default: 6.2e-07.
        conductivity_w_m_k
            Thermal conductivity, W/(m K). Default: 1.6.
        surface_resistance_m2_k_w
            Resistance between the surface and what warms and cools it, m2 K/W. Default: 0.0685.
        depth_m
            Depth of the axes of pipes that do not give theirs, m; that of the signal `ground.temperature_k`.
            Default: 1.0. Also depth_mm, depth_cm, depth_km.
        """
    def weather(
        self,
        *,
        kind: Literal["file", "synthetic", "constant"] | None = None,
        file: str | None = None,
        latitude_rad: float | None = None,
        latitude_deg: float | None = None,
        longitude_rad: float | None = None,
        longitude_deg: float | None = None,
        utc_offset_s: float | None = None,
        utc_offset_min: float | None = None,
        utc_offset_h: float | None = None,
        utc_offset_d: float | None = None,
        means: Literal["before", "after"] | None = None,
        time_column: str | None = None,
        separator: str | None = None,
        seed: int | None = None,
        mean_k: float | None = None,
        mean_degc: float | None = None,
        amplitude_k: float | None = None,
        coldest_day: float | None = None,
        winter_day_amplitude_k: float | None = None,
        summer_day_amplitude_k: float | None = None,
        noise_difference_k: float | None = None,
        noise_time_constant_s: float | None = None,
        noise_time_constant_min: float | None = None,
        noise_time_constant_h: float | None = None,
        noise_time_constant_d: float | None = None,
        clearness_alpha: float | None = None,
        clearness_beta: float | None = None,
        t_outdoor_k: float | None = None,
        t_outdoor_degc: float | None = None,
        relative_humidity: float | None = None,
        wind_m_s: float | None = None,
        global_horizontal_w_m2: float | None = None,
        diffuse_horizontal_w_m2: float | None = None,
        beam_normal_w_m2: float | None = None,
        sun_elevation_rad: float | None = None,
        sun_elevation_deg: float | None = None,
        sun_azimuth_rad: float | None = None,
        sun_azimuth_deg: float | None = None,
    ) -> None:
        """Adds `[weather]`.

        `[weather]`: outdoor temperature, humidity, wind, irradiance and sun.

        Parameters
        ----------
        kind
            Where it comes from. One of file, synthetic, constant. Default: file.
        file
            EPW (`.epw`) or CSV file, relative to the model file; file.
        latitude_rad
            Latitude, north positive, rad. An EPW file has its own; synthetic: Munich. Also latitude_deg.
        longitude_rad
            Longitude, east positive, rad. An EPW file has its own; synthetic: Munich. Also longitude_deg.
        utc_offset_s
            What the local standard time is ahead of UTC, s: of times in a CSV file without time zone, of the
            days of a synthetic year (1 h). An EPW file has its own. Also utc_offset_min, utc_offset_h,
            utc_offset_d.
        means
            Of which time the irradiance of a row is the mean; CSV. One of before, after. Default: before.
        time_column
            The column with the time: RFC 3339, or s since the start of the run. Absent: the first; CSV.
        separator
            Field separator; CSV. Default: ,.
        seed
            Start of the random numbers: another seed is another year; synthetic. Default: 0.
        mean_k
            Mean temperature of the year, K; synthetic. Default: 282.65. Also mean_degc.
        amplitude_k
            Amplitude of the temperature over the year, K; synthetic. Default: 10.0.
        coldest_day
            The coldest day of the mean year, 0 is New Year; synthetic. Default: 20.0.
        winter_day_amplitude_k
            Amplitude over a day in winter, K; synthetic. Default: 4.0.
        summer_day_amplitude_k
            Amplitude over a day in summer, K; synthetic. Default: 7.0.
        noise_difference_k
            Standard deviation of the weather around year and day, K; synthetic. Default: 3.5.
        noise_time_constant_s
            How long the weather remembers, s; synthetic. Default: 172800.0. Also noise_time_constant_min,
            noise_time_constant_h, noise_time_constant_d.
        clearness_alpha
            First parameter of the Beta distribution of the clearness of days; synthetic. Default: 1.5.
        clearness_beta
            Second parameter of the Beta distribution of the clearness of days; synthetic. Default: 1.0.
        t_outdoor_k
            Outdoor temperature, K; constant. Default: 283.15. Also t_outdoor_degc.
        relative_humidity
            Relative humidity, 0 to 1; constant. Default: 0.75.
        wind_m_s
            Wind, m/s; constant, synthetic. Default: 2.5.
        global_horizontal_w_m2
            Global irradiance on the horizontal, W/m2; constant. Default: 0.0.
        diffuse_horizontal_w_m2
            Diffuse irradiance on the horizontal, W/m2; constant. Default: 0.0.
        beam_normal_w_m2
            Irradiance of the sun on a plane that faces it, W/m2; constant. Default: 0.0.
        sun_elevation_rad
            Elevation of the sun, rad; constant. Default: 0.0. Also sun_elevation_deg.
        sun_azimuth_rad
            Azimuth of the sun from south, west positive, rad; constant. Default: 0.0. Also sun_azimuth_deg.
        """
    def tolerance(
        self,
        *,
        length: float | None = None,
        loss: float | None = None,
        surroundings_difference_k: float | None = None,
        friction: float | None = None,
        film: float | None = None,
        pump_head: float | None = None,
        exchanger: float | None = None,
        storage_loss: float | None = None,
        storage_mixing: float | None = None,
        efficiency: float | None = None,
        part_load: float | None = None,
        start: float | None = None,
        outlet_lag_s: float | None = None,
        outlet_lag_min: float | None = None,
        outlet_lag_h: float | None = None,
        outlet_lag_d: float | None = None,
    ) -> None:
        """Adds `[tolerance]`.

        `[tolerance]`: how far the numbers of the model may lie from those of the plant without an effect, each
        anywhere within plus or minus its tolerance. What is not given is known as well as usual
        (`docs/src/explain.md`). A run does not depend on it.

        Parameters
        ----------
        length
            Length of a pipe, relative.
        loss
            Heat loss of a pipe, relative.
        surroundings_difference_k
            Temperature around a pipe, K.
        friction
            Pressure loss of a pipe, relative.
        film
            Heat transfer between the water and the wall of a pipe, relative.
        pump_head
            Head of a pump, relative.
        exchanger
            Conductance of a heat exchanger, relative.
        storage_loss
            Heat loss of a storage, relative.
        storage_mixing
            Conduction along the height of a storage, relative: 1 for anything from half to twice.
        efficiency
            Efficiency of a generator at all loads, relative.
        part_load
            Efficiency of a generator at each part load by itself, relative.
        start
            Length of the start of a generator, relative.
        outlet_lag_s
            Time by which what leaves a generator follows what enters later than in the model, s. Also
            outlet_lag_min, outlet_lag_h, outlet_lag_d.
        """
    def pipe_type(
        self,
        id: str,
        *,
        pipe: str | None = None,
        length_m: float | None = None,
        length_mm: float | None = None,
        length_cm: float | None = None,
        length_km: float | None = None,
        inner_diameter_m: float | None = None,
        inner_diameter_mm: float | None = None,
        inner_diameter_cm: float | None = None,
        inner_diameter_km: float | None = None,
        roughness_m: float | None = None,
        roughness_mm: float | None = None,
        roughness_cm: float | None = None,
        roughness_km: float | None = None,
        zeta: float | None = None,
        friction: Literal["haaland", "colebrook", "swamee_jain", "hazen_williams", "chezy_manning"] | None = None,
        transition: Literal["cubic", "linear", "dunlop"] | None = None,
        hazen_williams_c: float | None = None,
        manning_n: float | None = None,
        fixed_velocity_m_s: float | None = None,
        friction_factor: float | None = None,
        delta_m: float | None = None,
        insulation_resistance_k_m_w: float | None = None,
        heat_loss_factor: float | None = None,
        wall: Literal["none", "end_volume", "equilibrium", "film"] | None = None,
        outer_diameter_m: float | None = None,
        outer_diameter_mm: float | None = None,
        outer_diameter_cm: float | None = None,
        outer_diameter_km: float | None = None,
        wall_density_kg_m3: float | None = None,
        wall_heat_capacity_j_kg_k: float | None = None,
        wall_heat_capacity_kj_kg_k: float | None = None,
        wall_capacity_j_m_k: float | None = None,
        wall_film_factor: float | None = None,
        dispersion_m2_s: float | None = None,
        standstill_loss_factor: float | None = None,
        laying: Literal["buried", "twin", "above_ground"] | None = None,
        wall_conductivity_w_m_k: float | None = None,
        casing_diameter_m: float | None = None,
        casing_diameter_mm: float | None = None,
        casing_diameter_cm: float | None = None,
        casing_diameter_km: float | None = None,
        casing_thickness_m: float | None = None,
        casing_thickness_mm: float | None = None,
        casing_thickness_cm: float | None = None,
        casing_thickness_km: float | None = None,
        insulation_thickness_m: float | None = None,
        insulation_thickness_mm: float | None = None,
        insulation_thickness_cm: float | None = None,
        insulation_thickness_km: float | None = None,
        insulation_conductivity_w_m_k: float | None = None,
        film_w_m2_k: float | None = None,
        depth_m: float | None = None,
        depth_mm: float | None = None,
        depth_cm: float | None = None,
        depth_km: float | None = None,
        spacing_m: float | None = None,
        spacing_mm: float | None = None,
        spacing_cm: float | None = None,
        spacing_km: float | None = None,
        companion: str | None = None,
        companion_reversed: bool | None = None,
        soil_rings: int | None = None,
        ground_capacity_j_m_k: float | None = None,
        ground_share: float | None = None,
        wind_m_s: float | None = None,
        outer_film_w_m2_k: float | None = None,
        surroundings_k: float | None = None,
        surroundings_degc: float | None = None,
        surroundings_difference_k: float | None = None,
        initial_k: float | None = None,
        initial_degc: float | None = None,
    ) -> str:
        """Adds `[pipe_type.ID]`.

        A pipe as written in a model file.

        Parameters
        ----------
        id
            Its name.
        pipe
            Name of a pipe of the catalogue on which it builds
        length_m
            Length, m. Also length_mm, length_cm, length_km.
        inner_diameter_m
            Inner diameter, m. Also inner_diameter_mm, inner_diameter_cm, inner_diameter_km.
        roughness_m
            Wall roughness, m. Default: pre-insulated steel. Default: 5e-05. Also roughness_mm, roughness_cm,
            roughness_km.
        zeta
            Sum of the loss coefficients of the fittings. Default: 0.0.
        friction
            Friction correlation of turbulent flow. One of haaland, colebrook, swamee_jain, hazen_williams,
            chezy_manning. Default: haaland.
        transition
            Passage from laminar to turbulent flow. One of cubic, linear, dunlop. Default: cubic.
        hazen_williams_c
            Roughness coefficient C of Hazen-Williams; with `friction = "hazen_williams"` only.
        manning_n
            Manning's n, s/m^(1/3); with `friction = "chezy_manning"` only.
        fixed_velocity_m_s
            Freezes the friction factor at this velocity, m/s: a purely quadratic law.
        friction_factor
            A friction factor (Darcy: four times Fanning's) that holds at any flow, instead of a correlation.
        delta_m
            Below this share of the nominal flow a fixed coefficient is regularised. Default: 0.3.
        insulation_resistance_k_m_w
            Thermal resistance water to surroundings per length, K m/W. Absent: no heat loss.
        heat_loss_factor
            Heat loss over what the other fields say. Default: 1.0.
        wall
            How the wall of the medium pipe stores heat. One of none, end_volume, equilibrium, film. Default:
            none.
        outer_diameter_m
            Outer diameter of the medium pipe, m. Also outer_diameter_mm, outer_diameter_cm, outer_diameter_km.
        wall_density_kg_m3
            Density of the wall, kg/m3. Default: steel. Default: 7850.0.
        wall_heat_capacity_j_kg_k
            Specific heat capacity of the wall, J/(kg K). Default: steel. Default: 460.0. Also
            wall_heat_capacity_kj_kg_k.
        wall_capacity_j_m_k
            Heat capacity of the wall per length, J/(m K), in place of the one from its diameters.
        wall_film_factor
            Multiplies the heat transfer between water and wall with `wall = "film"`. Default: 1.0.
        dispersion_m2_s
            Axial dispersion coefficient of the water, m2/s; 0 keeps fronts sharp. Default: 0.0.
        standstill_loss_factor
            Multiplies the heat loss while the water stands still. Default: 1.0.
        laying
            How it lies: its heat loss then follows from its layers, in place of `insulation_resistance_k_m_w`.
        wall_conductivity_w_m_k
            Thermal conductivity of the wall, W/(m K). Absent: 50, steel.
        casing_diameter_m
            Outer diameter of the casing around the insulation, m. Absent, without `insulation_thickness_m`: no
            insulation. Also casing_diameter_mm, casing_diameter_cm, casing_diameter_km.
        casing_thickness_m
            Wall thickness of the casing (PE), m. Absent: none. Also casing_thickness_mm, casing_thickness_cm,
            casing_thickness_km.
        insulation_thickness_m
            Thickness of the insulation, m, instead of `casing_diameter_m`. Also insulation_thickness_mm,
            insulation_thickness_cm, insulation_thickness_km.
        insulation_conductivity_w_m_k
            Thermal conductivity of the insulation, W/(m K). Absent: 0.028, polyurethane foam.
        film_w_m2_k
            Heat transfer from water to wall, W/(m2 K). Absent: 3500.
        depth_m
            Depth of the axis below the ground, m; of a twin pipe that of its casing. Absent: that of
            `[ground]`. Also depth_mm, depth_cm, depth_km.
        spacing_m
            Distance of the axes of this pipe and its companion, m: they exchange heat. The two lines of a
            trench are companions. Also spacing_mm, spacing_cm, spacing_km.
        companion
            The pipe beside it, by name; given on one of the two.
        companion_reversed
            Whether port a of the companion lies beside port b.
        soil_rings
            Rings of soil around a pipe buried alone that store heat, 1 to 5. Absent: the soil stores none.
        ground_capacity_j_m_k
            Heat capacity around the pipe per length, J/(m K): one node in its thermal resistance. Absent:
            none.
        ground_share
            Share of the thermal resistance that lies beyond that node. Absent: 0.5.
        wind_m_s
            Wind across a pipe in the air, m/s. Absent: 1.
        outer_film_w_m2_k
            Heat transfer from jacket to air, W/(m2 K). Absent: radiation and wind.
        surroundings_k
            Temperature around the pipe, K. Absent: the ground temperature of the model. Also
            surroundings_degc.
        surroundings_difference_k
            Added to the temperature around the pipe, K. Default: 0.0.
        initial_k
            Temperature of the water at the start, K. Absent: the initial temperature of the run. Also
            initial_degc.
        """
    def heat_pump_map(
        self,
        id: str,
        *,
        file: str | None = None,
        hplib_model: str | None = None,
        hplib_title: str | None = None,
        hplib_group: int | None = None,
        hplib_heat_w: float | None = None,
        hplib_heat_kw: float | None = None,
        hplib_heat_mw: float | None = None,
        hplib_electric_w: float | None = None,
        hplib_electric_kw: float | None = None,
        hplib_electric_mw: float | None = None,
        hplib_power_coefficients: Sequence[float] | None = None,
        hplib_ratio_coefficients: Sequence[float] | None = None,
        cooling: bool | None = None,
        modulation: Sequence[float] | None = None,
        source_k: Sequence[float] | None = None,
        source_degc: Sequence[float] | None = None,
        return_k: Sequence[float] | None = None,
        return_degc: Sequence[float] | None = None,
        supply_k: Sequence[float] | None = None,
        supply_degc: Sequence[float] | None = None,
        heat_w: Sequence[Sequence[float]] | None = None,
        heat_kw: Sequence[Sequence[float]] | None = None,
        heat_mw: Sequence[Sequence[float]] | None = None,
        electric_w: Sequence[Sequence[float]] | None = None,
        electric_kw: Sequence[Sequence[float]] | None = None,
        electric_mw: Sequence[Sequence[float]] | None = None,
        cop: Sequence[Sequence[float]] | None = None,
    ) -> str:
        """Adds `[heat_pump_map.ID]`.

        A performance map: a table (`source_k`, `return_k` or `supply_k`, `heat_w` and `electric_w` or `cop`),
        given here or in a CSV file, or a row of the database hplib.

        Parameters
        ----------
        id
            Its name.
        file
            CSV file relative to the model file: a table with a row per point and columns named like the fields
            of a map, or `hplib_database.csv`.
        hplib_model
            Row of the database: its column `Model`.
        hplib_title
            Row of the database where several have the model: its column `Titel`.
        hplib_group
            Group of the database: 1 air, 2 brine, 3 water, regulated; 4 air, 5 brine, 6 water, on/off. Needed
            for the model `Generic`.
        hplib_heat_w
            Heat at the reference point of the database (air -7, brine 0, water 10 degC; supply 52 degC), W:
            scales the unit; needed for the model `Generic`. Also hplib_heat_kw, hplib_heat_mw.
        hplib_electric_w
            Electricity at the reference point, W; read from the database. Also hplib_electric_kw,
            hplib_electric_mw.
        hplib_power_coefficients
            Coefficients of the relative electricity: of source, supply (1/K), constant, outdoor air (1/K),
            temperatures in degC; read from the database.
        hplib_ratio_coefficients
            The same of the COP, or of the EER.
        cooling
            Whether this is a map of cooling: the cold is in `heat_w`, the EER in `cop`.
        modulation
            Shares of the full speed, rising; one (or none) means that heat and electricity scale with the
            speed.
        source_k
            Temperatures of the source that arrives (of air, brine or water), K, rising. Also source_degc.
        return_k
            Temperatures of the water that arrives, K, rising. Also return_degc.
        supply_k
            Temperatures of the water that leaves, K, rising. Also supply_degc.
        heat_w
            Heat, W: a row per source temperature (per modulation all of them), a number per water temperature.
            Also heat_kw, heat_mw.
        electric_w
            Electricity, W, in the same order. Also electric_kw, electric_mw.
        cop
            Heat per electricity, in the same order, instead of the electricity.
        """
    def network(
        self,
        *,
        nodes: str | None = None,
        pipes: str | None = None,
        lines: Sequence[str] | None = None,
        separator: str | None = None,
    ) -> None:
        """Adds `[network]`.

        `[network]`: tables with the nodes and pipes of a network.

        Parameters
        ----------
        nodes
            The file with a site per row, relative to the model file.
        pipes
            The file with a trench per row, relative to the model file.
        lines
            Names of the lines of all sites of the table, the hot one first. Default: ['hot', 'cold'].
        separator
            Field separator of both files. Default: ,.
        """
    def house_type(
        self,
        id: str,
        *,
        station: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        unit: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        circuit: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        sensor: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        controller: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        schedule: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        series: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
    ) -> str:
        """Adds `[house_type.ID]`.

        Parameters
        ----------
        id
            Its name.
        station
            As [[station]], with names within the house
        unit
            As [[unit]], with names within the house
        circuit
            As [[circuit]], with names within the house
        sensor
            As [[sensor]], with names within the house
        controller
            As [[controller]], with names within the house
        schedule
            As [[schedule]], with names within the house
        series
            As [[series]], with names within the house
        """
    def house(
        self,
        site: str,
        type: str | Sequence[str] | None = None,
        *,
        station: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        unit: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        circuit: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        sensor: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        controller: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        schedule: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        series: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        connection: Literal["four_pipe", "two_pipe"] | None = None,
        set: Mapping[str, Any] | None = None,
        without: Sequence[str] | None = None,
    ) -> str | None:
        """Adds `[[house]]`.

        Parameters
        ----------
        site
            Site that it stands at
        type
            Name of a house_type or of a house of the library (SF1, SF2, SF3, SF4, MF5), or a list of them
        station
            As [[station]], with names within the house
        unit
            As [[unit]], with names within the house
        circuit
            As [[circuit]], with names within the house
        sensor
            As [[sensor]], with names within the house
        controller
            As [[controller]], with names within the house
        schedule
            As [[schedule]], with names within the house
        series
            As [[series]], with names within the house
        connection
            two_pipe: ports of a storage of its type at the same two heights become one pair of pipes that
            takes the difference One of four_pipe, two_pipe.
        set
            Single fields: "storage.volume_l" = 500
        without
            Parts of its type that are left out
        """
    def site(
        self,
        id: str,
        *,
        elevation_m: float | None = None,
        elevation_mm: float | None = None,
        elevation_cm: float | None = None,
        elevation_km: float | None = None,
        lines: Sequence[str] | None = None,
        x_m: float | None = None,
        x_mm: float | None = None,
        x_cm: float | None = None,
        x_km: float | None = None,
        y_m: float | None = None,
        y_mm: float | None = None,
        y_cm: float | None = None,
        y_km: float | None = None,
    ) -> str:
        """Adds `[[site]]`.

        `[[site]]`: a place with a node on each line.

        Parameters
        ----------
        id
            Name of the place.
        elevation_m
            Elevation, m. Default: 0.0. Also elevation_mm, elevation_cm, elevation_km.
        lines
            Names of its lines, the hot one first: a node `id.line` each. Default: ['hot', 'cold'].
        x_m
            Position on the map, m east. Also x_mm, x_cm, x_km.
        y_m
            Position on the map, m north. Also y_mm, y_cm, y_km.
        """
    def trench(
        self,
        from_: str,
        to: str,
        *,
        id: str | None = None,
        pipe: str | None = None,
        length_m: float | None = None,
        length_mm: float | None = None,
        length_cm: float | None = None,
        length_km: float | None = None,
        inner_diameter_m: float | None = None,
        inner_diameter_mm: float | None = None,
        inner_diameter_cm: float | None = None,
        inner_diameter_km: float | None = None,
        roughness_m: float | None = None,
        roughness_mm: float | None = None,
        roughness_cm: float | None = None,
        roughness_km: float | None = None,
        zeta: float | None = None,
        friction: Literal["haaland", "colebrook", "swamee_jain", "hazen_williams", "chezy_manning"] | None = None,
        transition: Literal["cubic", "linear", "dunlop"] | None = None,
        hazen_williams_c: float | None = None,
        manning_n: float | None = None,
        fixed_velocity_m_s: float | None = None,
        friction_factor: float | None = None,
        delta_m: float | None = None,
        insulation_resistance_k_m_w: float | None = None,
        heat_loss_factor: float | None = None,
        wall: Literal["none", "end_volume", "equilibrium", "film"] | None = None,
        outer_diameter_m: float | None = None,
        outer_diameter_mm: float | None = None,
        outer_diameter_cm: float | None = None,
        outer_diameter_km: float | None = None,
        wall_density_kg_m3: float | None = None,
        wall_heat_capacity_j_kg_k: float | None = None,
        wall_heat_capacity_kj_kg_k: float | None = None,
        wall_capacity_j_m_k: float | None = None,
        wall_film_factor: float | None = None,
        dispersion_m2_s: float | None = None,
        standstill_loss_factor: float | None = None,
        laying: Literal["buried", "twin", "above_ground"] | None = None,
        wall_conductivity_w_m_k: float | None = None,
        casing_diameter_m: float | None = None,
        casing_diameter_mm: float | None = None,
        casing_diameter_cm: float | None = None,
        casing_diameter_km: float | None = None,
        casing_thickness_m: float | None = None,
        casing_thickness_mm: float | None = None,
        casing_thickness_cm: float | None = None,
        casing_thickness_km: float | None = None,
        insulation_thickness_m: float | None = None,
        insulation_thickness_mm: float | None = None,
        insulation_thickness_cm: float | None = None,
        insulation_thickness_km: float | None = None,
        insulation_conductivity_w_m_k: float | None = None,
        film_w_m2_k: float | None = None,
        depth_m: float | None = None,
        depth_mm: float | None = None,
        depth_cm: float | None = None,
        depth_km: float | None = None,
        spacing_m: float | None = None,
        spacing_mm: float | None = None,
        spacing_cm: float | None = None,
        spacing_km: float | None = None,
        initial_degc: float | None = None,
        initial_k: float | None = None,
        soil_rings: int | None = None,
        ground_capacity_j_m_k: float | None = None,
        ground_share: float | None = None,
        wind_m_s: float | None = None,
        outer_film_w_m2_k: float | None = None,
        surroundings_k: float | None = None,
        surroundings_degc: float | None = None,
        surroundings_difference_k: float | None = None,
    ) -> str:
        """Adds `[[trench]]`.

        A pipe as written in a model file.

        Parameters
        ----------
        from_
            Site at port a
        to
            Site at port b
        id
            Name; default from-to
        pipe
            Name of a pipe_type, or of a pipe of the catalogue
        length_m
            Length, m. Also length_mm, length_cm, length_km.
        inner_diameter_m
            Inner diameter, m. Also inner_diameter_mm, inner_diameter_cm, inner_diameter_km.
        roughness_m
            Wall roughness, m. Default: pre-insulated steel. Default: 5e-05. Also roughness_mm, roughness_cm,
            roughness_km.
        zeta
            Sum of the loss coefficients of the fittings. Default: 0.0.
        friction
            Friction correlation of turbulent flow. One of haaland, colebrook, swamee_jain, hazen_williams,
            chezy_manning. Default: haaland.
        transition
            Passage from laminar to turbulent flow. One of cubic, linear, dunlop. Default: cubic.
        hazen_williams_c
            Roughness coefficient C of Hazen-Williams; with `friction = "hazen_williams"` only.
        manning_n
            Manning's n, s/m^(1/3); with `friction = "chezy_manning"` only.
        fixed_velocity_m_s
            Freezes the friction factor at this velocity, m/s: a purely quadratic law.
        friction_factor
            A friction factor (Darcy: four times Fanning's) that holds at any flow, instead of a correlation.
        delta_m
            Below this share of the nominal flow a fixed coefficient is regularised. Default: 0.3.
        insulation_resistance_k_m_w
            Thermal resistance water to surroundings per length, K m/W. Absent: no heat loss.
        heat_loss_factor
            Heat loss over what the other fields say. Default: 1.0.
        wall
            How the wall of the medium pipe stores heat. One of none, end_volume, equilibrium, film. Default:
            none.
        outer_diameter_m
            Outer diameter of the medium pipe, m. Also outer_diameter_mm, outer_diameter_cm, outer_diameter_km.
        wall_density_kg_m3
            Density of the wall, kg/m3. Default: steel. Default: 7850.0.
        wall_heat_capacity_j_kg_k
            Specific heat capacity of the wall, J/(kg K). Default: steel. Default: 460.0. Also
            wall_heat_capacity_kj_kg_k.
        wall_capacity_j_m_k
            Heat capacity of the wall per length, J/(m K), in place of the one from its diameters.
        wall_film_factor
            Multiplies the heat transfer between water and wall with `wall = "film"`. Default: 1.0.
        dispersion_m2_s
            Axial dispersion coefficient of the water, m2/s; 0 keeps fronts sharp. Default: 0.0.
        standstill_loss_factor
            Multiplies the heat loss while the water stands still. Default: 1.0.
        laying
            How it lies: its heat loss then follows from its layers, in place of `insulation_resistance_k_m_w`.
        wall_conductivity_w_m_k
            Thermal conductivity of the wall, W/(m K). Absent: 50, steel.
        casing_diameter_m
            Outer diameter of the casing around the insulation, m. Absent, without `insulation_thickness_m`: no
            insulation. Also casing_diameter_mm, casing_diameter_cm, casing_diameter_km.
        casing_thickness_m
            Wall thickness of the casing (PE), m. Absent: none. Also casing_thickness_mm, casing_thickness_cm,
            casing_thickness_km.
        insulation_thickness_m
            Thickness of the insulation, m, instead of `casing_diameter_m`. Also insulation_thickness_mm,
            insulation_thickness_cm, insulation_thickness_km.
        insulation_conductivity_w_m_k
            Thermal conductivity of the insulation, W/(m K). Absent: 0.028, polyurethane foam.
        film_w_m2_k
            Heat transfer from water to wall, W/(m2 K). Absent: 3500.
        depth_m
            Depth of the axis below the ground, m; of a twin pipe that of its casing. Absent: that of
            `[ground]`. Also depth_mm, depth_cm, depth_km.
        spacing_m
            Distance of the axes of this pipe and its companion, m: they exchange heat. The two lines of a
            trench are companions. Also spacing_mm, spacing_cm, spacing_km.
        initial_k
            Temperature of the water at the start, K. Absent: the initial temperature of the run. Also
            initial_degc.
        soil_rings
            Rings of soil around a pipe buried alone that store heat, 1 to 5. Absent: the soil stores none.
        ground_capacity_j_m_k
            Heat capacity around the pipe per length, J/(m K): one node in its thermal resistance. Absent:
            none.
        ground_share
            Share of the thermal resistance that lies beyond that node. Absent: 0.5.
        wind_m_s
            Wind across a pipe in the air, m/s. Absent: 1.
        outer_film_w_m2_k
            Heat transfer from jacket to air, W/(m2 K). Absent: radiation and wind.
        surroundings_k
            Temperature around the pipe, K. Absent: the ground temperature of the model. Also
            surroundings_degc.
        surroundings_difference_k
            Added to the temperature around the pipe, K. Default: 0.0.
        """
    def node(
        self,
        id: str,
        *,
        kind: Literal["junction", "pressure_boundary", "source"] | None = None,
        elevation_m: float | None = None,
        elevation_mm: float | None = None,
        elevation_cm: float | None = None,
        elevation_km: float | None = None,
        volume_m3: float | None = None,
        volume_l: float | None = None,
        ua_w_k: float | None = None,
        ua_kw_k: float | None = None,
        pressure_pa: float | None = None,
        pressure_hpa: float | None = None,
        pressure_mbar: float | None = None,
        pressure_kpa: float | None = None,
        pressure_bar: float | None = None,
        pressure_mpa: float | None = None,
        m_flow_kg_s: float | None = None,
        m_flow_kg_min: float | None = None,
        m_flow_kg_h: float | None = None,
        temperature_k: float | None = None,
        temperature_degc: float | None = None,
        min_pressure_pa: float | None = None,
        min_pressure_hpa: float | None = None,
        min_pressure_mbar: float | None = None,
        min_pressure_kpa: float | None = None,
        min_pressure_bar: float | None = None,
        min_pressure_mpa: float | None = None,
        max_pressure_pa: float | None = None,
        max_pressure_hpa: float | None = None,
        max_pressure_mbar: float | None = None,
        max_pressure_kpa: float | None = None,
        max_pressure_bar: float | None = None,
        max_pressure_mpa: float | None = None,
        x_m: float | None = None,
        x_mm: float | None = None,
        x_cm: float | None = None,
        x_km: float | None = None,
        y_m: float | None = None,
        y_mm: float | None = None,
        y_cm: float | None = None,
        y_km: float | None = None,
    ) -> str:
        """Adds `[[node]]`.

        `[[node]]`: a plain node.

        Parameters
        ----------
        id
            Name.
        kind
            What is known at it. One of junction, pressure_boundary, source. Default: junction.
        elevation_m
            Elevation, m. Default: 0.0. Also elevation_mm, elevation_cm, elevation_km.
        volume_m3
            Mixed water volume, m3. Default: 0.0. Also volume_l.
        ua_w_k
            Heat loss of this volume to the ground's temperature, W/K. Default: 0.0. Also ua_kw_k.
        pressure_pa
            Given pressure, Pa (pressure_boundary). Also pressure_hpa, pressure_mbar, pressure_kpa,
            pressure_bar, pressure_mpa.
        m_flow_kg_s
            Flow into the network, kg/s; negative takes water out (source). Also m_flow_kg_min, m_flow_kg_h.
        temperature_k
            Temperature of entering water, K (pressure_boundary, source). Also temperature_degc.
        min_pressure_pa
            Below this pressure the node raises `pressure_low`, Pa. Absent: never. Also min_pressure_hpa,
            min_pressure_mbar, min_pressure_kpa, min_pressure_bar, min_pressure_mpa.
        max_pressure_pa
            Above this pressure the node raises `pressure_high`, Pa. Absent: never. Also max_pressure_hpa,
            max_pressure_mbar, max_pressure_kpa, max_pressure_bar, max_pressure_mpa.
        x_m
            Position on the map, m east. Also x_mm, x_cm, x_km.
        y_m
            Position on the map, m north. Also y_mm, y_cm, y_km.
        """
    def three_way_valve(
        self,
        id: str,
        a: str,
        b: str,
        ab: str,
        *,
        mode: Literal["mixing", "diverting"] | None = None,
        kvs_ratio: float | None = None,
        characteristic_b: str | None = None,
        kvs_m3_h: float | None = None,
        characteristic: Literal["linear", "equal_percentage", "quick_opening", "table"] | None = None,
        rangeability: float | None = None,
        alpha: float | None = None,
        table_opening: Sequence[float] | None = None,
        table_phi: Sequence[float] | None = None,
        leakage: float | None = None,
        command: Literal["opening", "kappa"] | None = None,
        delta_m: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        switch_at: float | None = None,
        pulse_period_s: float | None = None,
        pulse_period_min: float | None = None,
        pulse_period_h: float | None = None,
        pulse_period_d: float | None = None,
        opening: float | None = None,
        kappa: float | None = None,
        initial_opening: float | None = None,
        stroke_time_s: float | None = None,
        stroke_time_min: float | None = None,
        stroke_time_h: float | None = None,
        stroke_time_d: float | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
    ) -> str:
        """Adds `[[three_way_valve]]`.

        A control valve as written in a model file.

        Parameters
        ----------
        id
            Name; the two ways are the edges `ID.a` and `ID.b`.
        a
            Node of the way that the command opens.
        b
            Node of the way that the command closes.
        ab
            Node that the two ways share.
        mode
            Which way is the positive flow. One of mixing, diverting. Default: mixing.
        kvs_ratio
            Flow coefficient of way b over that of way a. Default: 1.0.
        characteristic_b
            Characteristic of way b. Absent: that of way a.
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        characteristic
            Flow coefficient over the stroke. One of linear, equal_percentage, quick_opening, table. Default:
            equal_percentage.
        rangeability
            Ratio of largest to smallest controllable coefficient (equal percentage). Default: 50.0.
        alpha
            Root of the opening that the coefficient follows (quick opening). Default: 2.0.
        table_opening
            Openings of the table, rising from 0 to 1.
        table_phi
            Relative flow coefficients of the table without the leakage, rising from 0 to 1.
        leakage
            Coefficient of the closed valve over that of the open one; 0 is tight. Default: 0.001.
        command
            What the command means. One of opening, kappa. Default: opening.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.02.
        switch_at
            Command from which on it opens fully, and below which it closes: a switching valve. Absent: it
            takes any opening.
        pulse_period_s
            Period of a pulsing valve, s: it is open for the share of each period that its command has at the
            beginning of the period, then closed. Absent: the command is an opening. Also pulse_period_min,
            pulse_period_h, pulse_period_d.
        opening
            Opening commanded while nothing drives it. Not with `command = "kappa"`.
        kappa
            Relative flow coefficient commanded while nothing drives it, with `command = "kappa"`.
        initial_opening
            Opening at the start of a run. Absent: where the first command leads.
        stroke_time_s
            Time in which the stem follows a step by 99.6 %, s. Default: 35.0. Also stroke_time_min,
            stroke_time_h, stroke_time_d.
        m_flow_nominal_kg_s
            Nominal flow for the regularisation, kg/s. Absent: flow at 0.1 bar when open. Also
            m_flow_nominal_kg_h, m_flow_nominal_kg_min.
        """
    def four_way_mixer(
        self,
        id: str,
        source_supply: str,
        source_return: str,
        load_supply: str,
        load_return: str,
        *,
        kvs_m3_h: float | None = None,
        characteristic: Literal["linear", "equal_percentage", "quick_opening", "table"] | None = None,
        rangeability: float | None = None,
        alpha: float | None = None,
        table_opening: Sequence[float] | None = None,
        table_phi: Sequence[float] | None = None,
        leakage: float | None = None,
        command: Literal["opening", "kappa"] | None = None,
        delta_m: float | None = None,
        m_flow_nominal_kg_h: float | None = None,
        switch_at: float | None = None,
        pulse_period_s: float | None = None,
        pulse_period_min: float | None = None,
        pulse_period_h: float | None = None,
        pulse_period_d: float | None = None,
        opening: float | None = None,
        kappa: float | None = None,
        initial_opening: float | None = None,
        stroke_time_s: float | None = None,
        stroke_time_min: float | None = None,
        stroke_time_h: float | None = None,
        stroke_time_d: float | None = None,
        m_flow_nominal_kg_s: float | None = None,
        m_flow_nominal_kg_min: float | None = None,
    ) -> str:
        """Adds `[[four_way_mixer]]`.

        A control valve as written in a model file.

        Parameters
        ----------
        id
            Name; the ways are the edges `ID.supply`, `ID.return`, `ID.recirculation` and `ID.bypass`.
        source_supply
            Node from which the source's supply comes.
        source_return
            Node at which water goes back to the source.
        load_supply
            Node at which the mixed water goes to the load.
        load_return
            Node from which the load's return comes.
        kvs_m3_h
            Flow in m3/h at 1 bar when fully open.
        characteristic
            Flow coefficient over the stroke. One of linear, equal_percentage, quick_opening, table. Default:
            equal_percentage.
        rangeability
            Ratio of largest to smallest controllable coefficient (equal percentage). Default: 50.0.
        alpha
            Root of the opening that the coefficient follows (quick opening). Default: 2.0.
        table_opening
            Openings of the table, rising from 0 to 1.
        table_phi
            Relative flow coefficients of the table without the leakage, rising from 0 to 1.
        leakage
            Coefficient of the closed valve over that of the open one; 0 is tight. Default: 0.001.
        command
            What the command means. One of opening, kappa. Default: opening.
        delta_m
            Regularised below this share of the nominal flow. Default: 0.02.
        switch_at
            Command from which on it opens fully, and below which it closes: a switching valve. Absent: it
            takes any opening.
        pulse_period_s
            Period of a pulsing valve, s: it is open for the share of each period that its command has at the
            beginning of the period, then closed. Absent: the command is an opening. Also pulse_period_min,
            pulse_period_h, pulse_period_d.
        opening
            Opening commanded while nothing drives it. Not with `command = "kappa"`.
        kappa
            Relative flow coefficient commanded while nothing drives it, with `command = "kappa"`.
        initial_opening
            Opening at the start of a run. Absent: where the first command leads.
        stroke_time_s
            Time in which the stem follows a step by 99.6 %, s. Default: 35.0. Also stroke_time_min,
            stroke_time_h, stroke_time_d.
        m_flow_nominal_kg_s
            Nominal flow for the regularisation, kg/s. Absent: flow at 0.1 bar when open. Also
            m_flow_nominal_kg_h, m_flow_nominal_kg_min.
        """
    def interface(
        self,
        id: str,
        edge: str,
        *,
        pump: str | None = None,
        valve: str | None = None,
        extraction_pump: str | None = None,
        requested_flow_m3_s: float | None = None,
        requested_flow_l_s: float | None = None,
        requested_flow_l_min: float | None = None,
        requested_flow_l_h: float | None = None,
        requested_flow_m3_h: float | None = None,
        feed_in_set: str | None = None,
        extraction_set: str | None = None,
        feed_in_open: str | None = None,
        extraction_open: str | None = None,
        dead_time_s: float | None = None,
        dead_time_min: float | None = None,
        dead_time_h: float | None = None,
        dead_time_d: float | None = None,
        longest_step_s: float | None = None,
        longest_step_min: float | None = None,
        longest_step_h: float | None = None,
        longest_step_d: float | None = None,
    ) -> str:
        """Adds `[[interface]]`.

        `[[interface]]`: what a station is in a model written as plain nodes and edges.

        Parameters
        ----------
        id
            Name, for example "sf1.station".
        edge
            Edge whose flow from a to b is the station's feed-in.
        pump
            Pump that feeds in.
        valve
            Valve that extracts; stays closed until the pump has run down.
        extraction_pump
            Pump that extracts.
        requested_flow_m3_s
            Flow that the pump means to deliver, m3/s; decides the `blocked` flag. Also requested_flow_l_s,
            requested_flow_l_min, requested_flow_l_h, requested_flow_m3_h.
        feed_in_set
            Signal that gets the flow the unit on the edge asks for in feed-in, kg/s.
        extraction_set
            Signal that gets the flow the unit on the edge asks for in extraction, kg/s.
        feed_in_open
            Signal that is 1 while feed-in is asked for: a shut-off valve.
        extraction_open
            Signal that is 1 while extraction is asked for: a shut-off valve.
        dead_time_s
            Pause when the direction changes, s. Default: 0.0. Also dead_time_min, dead_time_h, dead_time_d.
        longest_step_s
            The longest step in which the controllers of its flow follow, s; a run with longer ones warns. Also
            longest_step_min, longest_step_h, longest_step_d.
        """
    def circuit(
        self,
        id: str,
        through: Sequence[str],
        *,
        site: str | None = None,
        v_flow_m3_s: float | None = None,
        v_flow_l_s: float | None = None,
        v_flow_l_min: float | None = None,
        v_flow_l_h: float | None = None,
        v_flow_m3_h: float | None = None,
        from_: str | None = None,
        to: str | None = None,
        resistance: float | None = None,
        idle_opening: float | None = None,
        suction: float | None = None,
        throttled: bool | None = None,
        check_valve: bool | None = None,
    ) -> str:
        """Adds `[[circuit]]`.

        `[[circuit]]`: a closed circuit of water in a house, through ports of its units.

        Parameters
        ----------
        id
            Name, within its site where one is given.
        through
            Ports in the order of the flow: `UNIT.PORT`, or `UNIT` where it has one port.
        site
            Site that it belongs to, in front of its name and of those of its units.
        v_flow_m3_s
            Flow of its own pump while nothing drives it, m3/s. Absent: one of its units sets the flow. Also
            v_flow_l_s, v_flow_l_min, v_flow_l_h, v_flow_m3_h.
        from_
            Point at which its water comes from others, for a circuit that is a branch between two points:
            `from = "return"`.
        to
            Point at which its water goes to others.
        resistance
            Of a branch: pressure loss over the square of the flow; only ratios count. 25 with a pump, 1
            without.
        idle_opening
            Of a branch with a pump: how far it is open while its pump is off, 0 (automatic valve, default) to
            1 (none).
        suction
            Of a branch with a pump: share of what the strongest parallel pump delivers more that it draws with
            it; 0.
        throttled
            Of a branch with a pump: whether it holds its flow also where others push more through it; true.
        check_valve
            Of a branch with a pump: whether a check valve keeps water from flowing back while the pump is off;
            false.
        """
    def sensor(
        self,
        id: str,
        measures: str,
        *,
        minus: str | None = None,
        time_constant_s: float | None = None,
        time_constant_min: float | None = None,
        time_constant_h: float | None = None,
        time_constant_d: float | None = None,
        dead_time_s: float | None = None,
        dead_time_min: float | None = None,
        dead_time_h: float | None = None,
        dead_time_d: float | None = None,
        offset: float | None = None,
        noise: float | None = None,
        resolution: float | None = None,
        seed: int | None = None,
    ) -> str:
        """Adds `[[sensor]]`.

        A sensor as written in a model file; its value is the channel `id.value`.

        Parameters
        ----------
        id
            Name.
        measures
            Channel that it measures.
        minus
            Channel that is subtracted, for a sensor of a difference.
        time_constant_s
            Time constant, s. Default: 0.0. Also time_constant_min, time_constant_h, time_constant_d.
        dead_time_s
            Time by which it is late, s. Default: 0.0. Also dead_time_min, dead_time_h, dead_time_d.
        offset
            Systematic error, in the SI unit of what is measured. Default: 0.0.
        noise
            Standard deviation of its noise, in the same unit; drawn anew at each step. Default: 0.0.
        resolution
            Step of its reading, in the same unit; 0 is continuous. Default: 0.0.
        seed
            Start of its random numbers. Default: 0.
        """
    def worst_point(
        self,
        id: str,
        between: Sequence[Sequence[str]],
    ) -> str:
        """Adds `[[worst_point]]`.

        `[[worst_point]]`: the smallest of several pressure differences, a channel `ID.dp_pa`.

        Parameters
        ----------
        id
            Name.
        between
            Pairs of nodes; each difference is that of the first against the second.
        """
    def prescribed(
        self,
        quantity: str,
        value: float,
        free: str,
        *,
        id: str | None = None,
        unit: str | None = None,
    ) -> str | None:
        """Adds `[[prescribed]]`.

        `[[prescribed]]`: a quantity that is given, and the actuator that is left free in its place.

        Parameters
        ----------
        quantity
            What is given: `EDGE.m_flow_kg_s`, `STATION.m_flow_kg_s`, `EDGE.dp_pa` or `NODE.p_pa`.
        value
            Its value.
        free
            The command that is free: `PUMP.speed`, `VALVE.opening`.
        id
            Name. Absent: the free actuator and `.prescribed`.
        unit
            Unit of the value. Absent: SI.
        """
    def schedule(
        self,
        signal: str,
        points: Sequence[Sequence[float]],
        *,
        unit: str | None = None,
        interpolation: Literal["hold", "linear"] | None = None,
    ) -> None:
        """Adds `[[schedule]]`.

        `[[schedule]]`: a signal over time, in the file.

        Parameters
        ----------
        signal
            The signal it drives.
        points
            Pairs of time in s and value.
        unit
            Unit of the values, for example "percent" or "degC". Absent: SI.
        interpolation
            Between the points. One of hold, linear. Default: hold.
        """
    def series(
        self,
        signal: str,
        file: str,
        column: str,
        *,
        unit: str | None = None,
        scale: float | None = None,
        offset: float | None = None,
        interpolation: Literal["hold", "linear"] | None = None,
        time_column: str | None = None,
        separator: str | None = None,
    ) -> None:
        """Adds `[[series]]`.

        `[[series]]`: a signal over time, from a column of a CSV file.

        Parameters
        ----------
        signal
            The signal it drives.
        file
            The file, relative to the model file.
        column
            The column.
        unit
            Unit of the values (after `scale` and `offset`). Absent: SI.
        scale
            What the values of the file are multiplied by: -1 turns a direction, a converter has its gain.
            Default: 1.0.
        offset
            What is added then. Default: 0.0.
        interpolation
            Between the rows. One of hold, linear. Default: hold.
        time_column
            The column with the time: s since the start, in another unit where its name says so (`time_h`,
            `hour`), or RFC 3339 with `[run] start`. Absent: the first.
        separator
            Field separator. Default: ,.
        """
    def pressure_reference(
        self,
        node: str,
        *,
        pressure_pa: float | None = None,
        pressure_hpa: float | None = None,
        pressure_mbar: float | None = None,
        pressure_kpa: float | None = None,
        pressure_bar: float | None = None,
        pressure_mpa: float | None = None,
        vessel_volume_m3: float | None = None,
        vessel_volume_l: float | None = None,
        vessel_precharge_pa: float | None = None,
        vessel_precharge_hpa: float | None = None,
        vessel_precharge_mbar: float | None = None,
        vessel_precharge_kpa: float | None = None,
        vessel_precharge_bar: float | None = None,
        vessel_precharge_mpa: float | None = None,
        min_pressure_pa: float | None = None,
        min_pressure_hpa: float | None = None,
        min_pressure_mbar: float | None = None,
        min_pressure_kpa: float | None = None,
        min_pressure_bar: float | None = None,
        min_pressure_mpa: float | None = None,
        max_pressure_pa: float | None = None,
        max_pressure_hpa: float | None = None,
        max_pressure_mbar: float | None = None,
        max_pressure_kpa: float | None = None,
        max_pressure_bar: float | None = None,
        max_pressure_mpa: float | None = None,
    ) -> None:
        """Adds `[[pressure_reference]]`.

        `[pressure_reference]` (or several as `[[pressure_reference]]`): pressure holding of a circuit.

        Parameters
        ----------
        node
            The node.
        pressure_pa
            Its pressure above the atmosphere, Pa; with a vessel that at the start of the run. Default:
            150000.0. Also pressure_hpa, pressure_mbar, pressure_kpa, pressure_bar, pressure_mpa.
        vessel_volume_m3
            Volume of a membrane expansion vessel at the node, m3. Absent: the pressure is held whatever
            happens. Also vessel_volume_l.
        vessel_precharge_pa
            Pressure above the atmosphere of the gas in the vessel while it holds no water, Pa. Also
            vessel_precharge_hpa, vessel_precharge_mbar, vessel_precharge_kpa, vessel_precharge_bar,
            vessel_precharge_mpa.
        min_pressure_pa
            Below this pressure anywhere its circuit raises `pressure_low`, Pa. Absent: never. Also
            min_pressure_hpa, min_pressure_mbar, min_pressure_kpa, min_pressure_bar, min_pressure_mpa.
        max_pressure_pa
            Above this pressure anywhere its circuit raises `pressure_high`, Pa. Absent: never. Also
            max_pressure_hpa, max_pressure_mbar, max_pressure_kpa, max_pressure_bar, max_pressure_mpa.
        """
