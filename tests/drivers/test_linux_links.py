"""What `ip -json` says of a CAN interface (iproute2 6.1)."""

from drivers.bus_health import Link, link_from_json, link_of

CAN0 = """[{"ifindex":4,"ifname":"can0","flags":["NOARP","UP","LOWER_UP","ECHO"],"mtu":16,"operstate":"UP",
"link_type":"can","linkinfo":{"info_kind":"can","info_data":{"ctrlmode":["LISTEN-ONLY","BERR-REPORTING"],
"state":"ERROR-PASSIVE","berr_counter":{"tx":128,"rx":3},"restart_ms":0,
"bittiming":{"bitrate":500000,"sample_point":"0.875","tq":125,"prop_seg":6},"clock":8000000},
"info_xstats":{"restarts":2,"bus_error":17,"arbitration_lost":0,"error_warning":1,"error_passive":1,"bus_off":0}},
"stats64":{"rx":{"bytes":0,"packets":0,"errors":0,"dropped":9},"tx":{"bytes":0}}}]"""
VCAN0 = '[{"ifname":"vcan0","flags":["NOARP"],"linkinfo":{"info_kind":"vcan"}}]'


def test_state_counters_and_bit_rate():
    assert link_from_json(CAN0) == Link(
        up=True,
        state="ERROR-PASSIVE",
        bit_rate=500_000,
        transmit_errors=128,
        receive_errors=3,
        bus_errors=17,
        restarts=2,
        listen_only=True,
        dropped=9,
    )


def test_an_interface_without_a_controller():
    assert link_from_json(VCAN0) == Link(up=False)


def test_nothing_is_told_of_what_is_no_interface():
    assert link_from_json("Device does not exist") is None
    assert link_from_json("[{}]") == Link(up=False)
    assert link_from_json("[]") is None
    assert link_of("no such interface") is None
