"""People sign in by OpenID Connect (docs/how-to/sign-in.md): settings, the provider, what it vouches for."""

from hil.service.sign_in._settings import SignInSettings, read_settings
from hil.service.sign_in._sign_in import SignedIn, SignIn, SignInRequest, local_place
from hil.service.sign_in._tried import SignInError

__all__ = [
    "SignIn",
    "SignInError",
    "SignInRequest",
    "SignInSettings",
    "SignedIn",
    "local_place",
    "read_settings",
]
