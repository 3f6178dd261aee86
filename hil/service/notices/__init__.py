"""Notices by webhook and mail: a run has ended or waits for approval, a bench was stopped."""

from hil.service.notices._post import Post
from hil.service.notices._settings import NoticeSettings, read_settings
from hil.service.notices._watch import NoticeWatch, send_test

__all__ = ["NoticeSettings", "NoticeWatch", "Post", "read_settings", "send_test"]
