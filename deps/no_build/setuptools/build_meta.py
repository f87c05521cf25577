"""A build backend (PEP 517) that builds nothing.

For the metadata of a downloaded source package, pip would run the package's build. Only the C sources are used here,
so this backend replaces setuptools and returns the metadata from the package.
"""
import email
import os
import shutil


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    with open('PKG-INFO', encoding='utf-8') as file:
        package = email.message_from_file(file)
    folder = f'{package["Name"]}-{package["Version"]}.dist-info'
    os.mkdir(os.path.join(metadata_directory, folder))
    shutil.copyfile('PKG-INFO', os.path.join(metadata_directory, folder, 'METADATA'))
    return folder


def build_wheel(*_, **__):
    raise RuntimeError('Source packages are unpacked, never built by pip.')
